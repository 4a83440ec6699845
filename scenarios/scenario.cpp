#include "scenarios/scenario.h"

#include "base/error.h"
#include "physics/parameters.h"
#include "scenarios/world_tables.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::scenarios {

namespace {

constexpr double kLongestRun = 86'400.0 * 30;  // s; simulated time itself reaches 106 days

/// A list of times, each later than the one before, all after `start`.
std::vector<double> read_times(Reader& reader, std::string_view key, double start) {
    std::vector<double> times;
    for (const std::string& text : reader.texts(key)) {
        try {
            times.push_back(parse_quantity(text, Dimension::Time));
        } catch (const QuantityError& error) {
            reader.fail(key, fmt::format("{}: {}", key, error.problem), error.expected);
        }
        if (times.back() <= (times.size() > 1 ? times[times.size() - 2] : start))
            reader.fail(key, fmt::format("the times of {} do not rise from {:g} s on", key, start),
                        "times later than that, each later than the one before");
    }
    return times;
}

PicBoard read_pic(const std::string& file, const std::string& where, const TomlValue& table,
                  const std::filesystem::path& folder) {
    Reader reader(file, where, table);
    PicBoard pic;
    pic.firmware = folder / reader.text("firmware");
    pic.crystal_ppm = reader.quantity("crystal_error", Dimension::Ratio, 0.0) * 1e6;
    if (std::abs(pic.crystal_ppm) > 10'000)
        reader.fail("crystal_error", "crystal_error is out of range", "-1 % to 1 %, such as \"20 ppm\"");
    pic.adc_noise = reader.quantity("adc_noise", Dimension::Number, pic.adc_noise);
    if (pic.adc_noise < 0 || pic.adc_noise > 1000)
        reader.fail("adc_noise", "adc_noise is out of range", "0 to 1000 counts");
    pic.selector = static_cast<int>(reader.integer("selector", 0, 0, 15));
    pic.uart1 = reader.text("uart1", "");
    pic.resets = read_times(reader, "reset", 0.0);
    reader.finish();
    return pic;
}

LinuxBoard read_linux(const std::string& file, const std::string& where, const TomlValue& table,
                      const std::string& robot_name) {
    Reader reader(file, where, table);
    LinuxBoard board;
    board.command = reader.texts("program");
    if (board.command.empty())
        reader.fail("program", "'program' is missing", "program = [\"./controller\", \"-x\"]");
    board.hostname = reader.text("hostname", robot_name);
    board.start = reader.quantity("start", Dimension::Time, 0.0);
    if (board.start < 0) reader.fail("start", "start is before the run begins", "0 s or later");
    board.restarts = read_times(reader, "restart", board.start);
    board.place_line = table.line;
    reader.finish();
    return board;
}

void read_robot(const std::string& file, const TomlValue& table, const std::filesystem::path& folder,
                Scenario& scenario) {
    const std::string fallback = fmt::format("robot{}", scenario.robots.size());
    Reader reader(file, fallback, table);
    RobotBoards boards;
    physics::Robot body;
    boards.name = body.name = reader.text("name", fallback);
    const bool plain =
        !boards.name.empty() && std::all_of(boards.name.begin(), boards.name.end(), [](char c) {
            return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
                   c == '-';
        });
    constexpr std::size_t kLongestName = 64;
    if (boards.name.size() > kLongestName) reader.fail("name", "the name is too long", "at most 64 letters");
    if (!plain)
        reader.fail("name", "the name has other signs than letters, digits, _ and -",
                    "a name such as epuck12");
    for (const RobotBoards& other : scenario.robots)
        if (other.name == boards.name)
            reader.fail("name", fmt::format("two robots are called '{}'", boards.name));
    const auto position = reader.quantities("position", Dimension::Length, 2);
    body.x = position[0];
    body.y = position[1];
    body.heading = reader.quantity("heading", Dimension::Angle, 0.0);
    body.place = fmt::format("line {}", table.line);
    if (const TomlValue* parameters = reader.table("parameters"))
        body.parameters = read_parameters(file, boards.name, *parameters);
    const TomlValue* pic = reader.table("pic");
    if (!pic) reader.fail("pic", "[robot.pic] is missing", "[robot.pic] with firmware = \"image.hex\"");
    boards.pic = read_pic(file, boards.name + ".pic", *pic, folder);
    if (const TomlValue* linux_table = reader.table("linux"))
        boards.linux_board = read_linux(file, boards.name + ".linux", *linux_table, boards.name);
    boards.ground_sensor = reader.flag("ground_sensor", true);
    boards.rgb_turret = reader.flag("rgb_turret", true);
    reader.finish();
    scenario.robots.push_back(std::move(boards));
    scenario.world.robots.push_back(std::move(body));
}

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

cosim::FaultSpec read_fault(const std::string& file, std::size_t index, const TomlValue& table,
                            const Scenario& scenario) {
    Reader reader(file, fmt::format("fault {}", index + 1), table);
    cosim::FaultSpec fault;
    fault.link = reader.text("link");
    fault.from = reader.text("from", "");
    const std::vector<std::string> kinds{"drop", "flip", "delay", "duplicate", "disconnect", "stuck", "rate"};
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
        run.finish();
    }
    const double period = scenario.world.recording.period;
    scenario.world = read_world(top);
    scenario.world.recording.period = period;
    scenario.world.seed = scenario.seed;
    for (const TomlValue* table : top.tables("robot"))
        read_robot(name, *table, file.parent_path(), scenario);
    if (scenario.robots.empty()) top.fail("robot", "no robot", "at least one [[robot]]");
    std::size_t index = 0;
    for (const TomlValue* table : top.tables("fault"))
        scenario.faults.push_back(read_fault(name, index++, *table, scenario));
    top.finish();
    const bool any_program =
        std::any_of(scenario.robots.begin(), scenario.robots.end(),
                    [](const RobotBoards& robot) { return robot.linux_board.has_value(); });
    if (!scenario.duration && !any_program)
        top.fail("run", "nothing ends this run",
                 "[run] with a duration, or a robot with a [robot.linux] program");
    physics::check(scenario.world);
    return scenario;
}

void apply_overlay(Scenario& scenario, const std::filesystem::path& file) {
    const TomlValue root = read_toml(file);
    const std::string name = file.string();
    Reader top(name, "", root);
    if (const TomlValue* table = top.table("parameters"))
        for (const auto& [parameter, value] : read_parameters(name, "parameters", *table))
            scenario.world.parameters[parameter] = value;
    for (const TomlValue* table : top.tables("robot")) {
        Reader reader(name, "robot", *table);
        const std::string robot_name = reader.text("name");
        const auto body = std::find_if(scenario.world.robots.begin(), scenario.world.robots.end(),
                                       [&](const physics::Robot& robot) { return robot.name == robot_name; });
        if (body == scenario.world.robots.end())
            reader.fail("name", fmt::format("the scenario has no robot '{}'", robot_name));
        if (const TomlValue* parameters = reader.table("parameters"))
            for (const auto& [parameter, value] : read_parameters(name, robot_name, *parameters))
                body->parameters[parameter] = value;
        reader.finish();
    }
    top.finish();
    physics::check(scenario.world);
}

}  // namespace puckloop::scenarios
