#include "scenarios/scenario.h"

#include "base/error.h"
#include "physics/parameters.h"
#include "scenarios/events/event_tables.h"
#include "scenarios/robot_tables.h"
#include "scenarios/tam_tables.h"
#include "scenarios/world_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace puckloop::scenarios {

namespace {

constexpr double kLongestRun = 86'400.0 * 30;  // s; simulated time itself reaches 106 days

/// Faults sit on the UART links, which join the boards of a robot.
void check_fault_link(Reader& reader, const std::string& link, const Scenario& scenario) {
    std::string known;
    for (const RobotBoards& robot : scenario.robots) {
        if (!robot.linux_board) continue;
        const std::string uart = robot.name + ".uart";
        if (uart == link) return;
        known += (known.empty() ? "" : ", ") + uart;
    }
    reader.fail("link", fmt::format("there is no UART link '{}'", link),
                known.empty() ? "a robot with a [robot.linux] program" : known);
}

/// bytes = ["0x00", "0xFF"].
std::vector<std::uint8_t> read_bytes(Reader& reader) {
    std::vector<std::uint8_t> bytes;
    for (const std::string& text : reader.texts("bytes")) {
        const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
        const char* const first = text.data() + (hexadecimal ? 2 : 0);
        const char* const last = text.data() + text.size();
        std::uint8_t value = 0;
        const auto [end, error] = std::from_chars(first, last, value, hexadecimal ? 16 : 10);
        if (error != std::errc() || end != last)
            reader.fail("bytes", fmt::format("'{}' is not a byte", text), "such as \"0x7F\" or \"127\"");
        bytes.push_back(value);
    }
    if (bytes.empty())
        reader.fail("bytes", "bytes is empty", "such as [\"0x00\", \"0xFF\"], or no 'bytes' for all");
    return bytes;
}

cosim::FaultSpec read_fault(const std::string& file, std::size_t index, const TomlValue& table,
                            const Scenario& scenario) {
    Reader reader(file, fmt::format("fault {}", index + 1), table);
    cosim::FaultSpec fault;
    fault.link = reader.text("link");
    fault.from = reader.text("from", "");
    const std::vector<std::string> kinds{"drop",       "flip",  "delay", "duplicate",
                                         "disconnect", "stuck", "rate",  "cut"};
    fault.kind = *cosim::fault_of_name(reader.choice("kind", "drop", kinds));
    fault.probability = reader.quantity("probability", Dimension::Ratio, 1.0);
    if (!(fault.probability >= 0 && fault.probability <= 1))
        reader.fail("probability", "probability is out of range", "0 to 1, or \"5 %\"");
    if (reader.has("count"))
        fault.count = static_cast<std::uint64_t>(reader.integer("count", 1, 1, 1'000'000'000));
    fault.begin = cosim::from_seconds(reader.quantity("begin", Dimension::Time, 0.0));
    if (const auto end = reader.optional_quantity("end", Dimension::Time))
        fault.end = cosim::from_seconds(*end);
    if (fault.begin < 0 || fault.end <= fault.begin)
        reader.fail("begin", "the fault's window is empty", "0 s <= begin < end");
    if (fault.kind == cosim::FaultKind::Delay) fault.amount = reader.quantity("delay", Dimension::Time);
    if (fault.kind == cosim::FaultKind::Rate) fault.amount = reader.quantity("factor", Dimension::Ratio);
    if (fault.kind == cosim::FaultKind::Cut) {
        fault.again = reader.quantity("again", Dimension::Ratio, 0.0);
        if (!(fault.again >= 0 && fault.again <= 1))
            reader.fail("again", "again is out of range", "0 to 1, or \"30 %\"");
    } else if (reader.has("bytes")) {
        fault.bytes = read_bytes(reader);
    }
    reader.finish();
    check_fault_link(reader, fault.link, scenario);
    const std::string robot = fault.link.substr(0, fault.link.rfind('.'));
    if (!fault.from.empty() && fault.from != robot + ".linux" && fault.from != robot + ".pic")
        reader.fail("from", fmt::format("'{}' is at no end of {}", fault.from, fault.link),
                    fmt::format("{0}.linux or {0}.pic", robot));
    return fault;
}

}  // namespace

Scenario read_scenario(const std::filesystem::path& file) {
    const TomlValue root = read_toml(file);
    const std::string name = file.string();
    Reader top(name, "", root);
    Scenario scenario;
    scenario.file = file;
    scenario.name = file.stem().string();
    if (const TomlValue* table = top.table("run")) {
        Reader run(name, "run", *table);
        scenario.duration = run.optional_quantity("duration", Dimension::Time);
        if (scenario.duration && (*scenario.duration <= 0 || *scenario.duration > kLongestRun))
            run.fail("duration", "duration is out of range", "more than 0 s, at most 720 h");
        scenario.seed =
            static_cast<std::uint64_t>(run.integer("seed", 1, 0, std::numeric_limits<std::int64_t>::max()));
        scenario.world.recording.period = run.quantity("record_every", Dimension::Time, 0.1);
        scenario.uart_baud = run.quantity("uart_baud", Dimension::Number, scenario.uart_baud);
        if (scenario.uart_baud < 300 || scenario.uart_baud > 4e6)
            run.fail("uart_baud", "uart_baud is out of range", "300 to 4000000");
        scenario.i2c_clock = run.quantity("i2c_clock", Dimension::Frequency, scenario.i2c_clock);
        if (scenario.i2c_clock < 1e3 || scenario.i2c_clock > 1e6)
            run.fail("i2c_clock", "i2c_clock is out of range", "1 kHz to 1 MHz");
        scenario.record_ir = run.flag("record_ir", false);
        run.finish();
    }
    const double period = scenario.world.recording.period;
    scenario.world = read_world(top);
    scenario.world.recording.period = period;
    scenario.world.seed = scenario.seed;
    for (const TomlValue* table : top.tables("robot"))
        read_robot(name, *table, file.parent_path(), scenario);
    for (const TomlValue* table : top.tables("tam"))
        read_tam(name, *table, file.parent_path(), scenario);
    if (scenario.robots.empty() && scenario.tams.empty())
        top.fail("robot", "no robot", "at least one [[robot]] or [[tam]]");
    std::size_t index = 0;
    for (const TomlValue* table : top.tables("fault"))
        scenario.faults.push_back(read_fault(name, index++, *table, scenario));
    scenario.events.events = read_events(top);
    top.finish();
    physics::check(scenario.world);
    physics::check_events(scenario.events, scenario.world);
    return scenario;
}

void check_ending(const Scenario& scenario) {
    const bool any_program =
        std::any_of(scenario.robots.begin(), scenario.robots.end(),
                    [](const RobotBoards& robot) { return robot.linux_board.has_value(); });
    if (!scenario.duration && !any_program)
        throw InputError(scenario.file.string(), "[run]", "nothing ends this run",
                         "duration = \"60 s\", a robot with a [robot.linux] program, or --duration");
}

}  // namespace puckloop::scenarios
