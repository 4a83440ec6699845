#include "scenarios/robot_tables.h"

#include "scenarios/board_keys.h"
#include "scenarios/world_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstring>
#include <limits>

namespace puckloop::scenarios {

namespace {

constexpr double kLongestGrace = 3600.0;  // s

/// The file that keeps a board's memory: nobody else's.
std::filesystem::path read_nvm(Reader& reader, const std::filesystem::path& folder,
                               const std::vector<std::filesystem::path>& others) {
    const std::string name = reader.text("nvm", "");
    if (name.empty()) return {};
    std::error_code ignored;
    const std::filesystem::path file = folder / name;
    for (const std::filesystem::path& other : others)
        if (std::filesystem::weakly_canonical(other, ignored) ==
            std::filesystem::weakly_canonical(file, ignored))
            reader.fail("nvm", fmt::format("'{}' keeps another board's memory already", name),
                        "a file of its own for each board");
    return file;
}

PicBoard read_pic(const std::string& file, const std::string& where, const TomlValue& table,
                  const std::filesystem::path& folder, const std::vector<std::filesystem::path>& others) {
    Reader reader(file, where, table);
    PicBoard pic;
    pic.firmware = folder / reader.text("firmware");
    pic.crystal_ppm = read_clock_error(reader, "crystal_error");
    pic.adc_noise = read_adc_noise(reader, pic.adc_noise);
    pic.selector = static_cast<int>(reader.integer("selector", 0, 0, 15));
    pic.uart1 = reader.text("uart1", "");
    pic.resets = read_times(reader, "reset", 0.0);
    pic.nvm = read_nvm(reader, folder, others);
    constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();
    if (const double boot = reader.quantity("boot", Dimension::Time, kNotGiven); !std::isnan(boot)) {
        constexpr double kLongest = 86'400.0 * 30;  // s, as a run
        if (!(boot >= 0 && boot <= kLongest))
            reader.fail("boot", "boot is out of range", "0 s to 720 h, such as \"40 s\"");
        pic.boot = boot;
    }
    reader.finish();
    return pic;
}

RabBoard read_rab(const std::string& file, const std::string& where, const TomlValue& table,
                  const std::filesystem::path& folder, const std::vector<std::filesystem::path>& others) {
    Reader reader(file, where, table);
    RabBoard rab;
    rab.firmware = folder / reader.text("firmware");
    rab.crystal_ppm = read_clock_error(reader, "crystal_error");
    rab.adc_noise = read_adc_noise(reader, rab.adc_noise);
    rab.nvm = read_nvm(reader, folder, others);
    reader.finish();
    return rab;
}

/// A signal's name without its SIG; one that ends a program or that programs handle.
std::string read_signal(Reader& reader, std::string_view key, const std::string& fallback) {
    std::string name = fallback.empty() ? reader.text(key) : reader.text(key, fallback);
    if (name.starts_with("SIG")) name.erase(0, 3);
    for (const char* stops : {"STOP", "TSTP", "TTIN", "TTOU"})
        if (name == stops)
            reader.fail(key, fmt::format("'{}' stops a program, which simulated time does not know", name),
                        "a signal that ends it or that it handles, such as \"INT\"");
    for (int number = 1; number < NSIG; ++number)
        if (const char* known = sigabbrev_np(number); known != nullptr && name == known) return name;
    reader.fail(key, fmt::format("there is no signal '{}'", name),
                "a name such as \"INT\", \"TERM\" or \"USR1\"");
}

std::vector<LinuxSignal> read_signals(Reader& reader) {
    std::vector<LinuxSignal> signals;
    for (const TomlValue* table : reader.tables("signals")) {
        Reader entry(reader.file(), "signals", *table);
        LinuxSignal signal;
        signal.at = entry.quantity("at", Dimension::Time);
        if (signal.at < 0 || (!signals.empty() && signal.at < signals.back().at))
            entry.fail("at", "the times of signals do not rise from 0 s on", "times in order");
        signal.send = read_signal(entry, "send", "");
        entry.finish();
        signals.push_back(signal);
    }
    return signals;
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
    board.folder = reader.text("folder", "");
    if (const std::filesystem::path path(board.folder);
        path.is_absolute() || board.folder.find("..") != std::string::npos)
        reader.fail("folder", "folder is not below the results", "a relative path such as \"robot0\"");
    board.signals = read_signals(reader);
    board.end_signal = read_signal(reader, "end_signal", board.end_signal);
    board.grace = reader.quantity("grace", Dimension::Time, board.grace);
    if (board.grace < 0 || board.grace > kLongestGrace)
        reader.fail("grace", "grace is out of range", "0 s to 1 h");
    read_lateness(reader, board.late);
    board.place_line = table.line;
    reader.finish();
    return board;
}

}  // namespace

void read_lateness(Reader& reader, LinuxLateness& late) {
    constexpr double kLongest = 1.0;  // s
    const auto read = [&](const char* key, double& value) {
        value = reader.quantity(key, Dimension::Time, value);
        if (!(value >= 0 && value <= kLongest))
            reader.fail(key, fmt::format("{} is out of range", key), "0 to 1 s, such as \"4 ms\"");
    };
    read("tty_batch", late.tty_batch);
    read("i2c_hold", late.i2c_hold);
    read("oversleep", late.oversleep);
    read("oversleep_jitter", late.oversleep_jitter);
}

void read_robot(const std::string& file, const TomlValue& table, const std::filesystem::path& folder,
                Scenario& scenario) {
    const std::string fallback = fmt::format("robot{}", scenario.robots.size());
    Reader reader(file, fallback, table);
    RobotBoards boards;
    physics::Robot body;
    boards.name = body.name = read_name(reader, fallback, scenario);
    const auto position = reader.quantities("position", Dimension::Length, 2);
    body.x = position[0];
    body.y = position[1];
    body.heading = reader.quantity("heading", Dimension::Angle, 0.0);
    body.place = fmt::format("line {}", table.line);
    if (const TomlValue* parameters = reader.table("parameters"))
        body.parameters = read_parameters(file, boards.name, *parameters);
    std::vector<std::filesystem::path> memories;
    for (const RobotBoards& other : scenario.robots) {
        if (!other.pic.nvm.empty()) memories.push_back(other.pic.nvm);
        if (other.rab && !other.rab->nvm.empty()) memories.push_back(other.rab->nvm);
    }
    const TomlValue* pic = reader.table("pic");
    if (!pic) reader.fail("pic", "[robot.pic] is missing", "[robot.pic] with firmware = \"image.hex\"");
    boards.pic = read_pic(file, boards.name + ".pic", *pic, folder, memories);
    if (!boards.pic.nvm.empty()) memories.push_back(boards.pic.nvm);
    if (const TomlValue* rab = reader.table("rab"))
        boards.rab = read_rab(file, boards.name + ".rab", *rab, folder, memories);
    if (const TomlValue* linux_table = reader.table("linux"))
        boards.linux_board = read_linux(file, boards.name + ".linux", *linux_table, boards.name);
    boards.ground_sensor = reader.flag("ground_sensor", true);
    boards.rgb_turret = reader.flag("rgb_turret", true);
    reader.finish();
    scenario.robots.push_back(std::move(boards));
    scenario.world.robots.push_back(std::move(body));
}

}  // namespace puckloop::scenarios
