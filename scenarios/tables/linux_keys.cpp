#include "scenarios/tables/linux_keys.h"

#include "scenarios/tables/board_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <filesystem>

namespace puckloop::scenarios {

namespace {

constexpr double kLongestGrace = 3600.0;  // s

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

/// What a Linux board has under these names, or below these folders, whatever is connected to it.
constexpr std::array kBoardsOwn{"/dev/null", "/dev/zero",  "/dev/full",   "/dev/random", "/dev/urandom",
                                "/dev/tty",  "/dev/stdin", "/dev/stdout", "/dev/stderr", "/dev/console",
                                "/dev/ptmx", "/dev/fd",    "/dev/pts",    "/dev/shm",    "/dev/mem"};

bool is_boards_own(const std::string& name) {
    return std::any_of(kBoardsOwn.begin(), kBoardsOwn.end(),
                       [&](const std::string& own) { return name == own || name.starts_with(own + "/"); });
}

/// The names in `key`, the device's own first; `fallback` without the key.
std::vector<std::string> read_names(Reader& reader, std::string_view key, std::vector<std::string> fallback) {
    constexpr std::size_t kMost = 3;
    if (!reader.has(key)) return fallback;
    std::vector<std::string> names = reader.texts(key);
    if (names.empty() || names.size() > kMost)
        reader.fail(key, fmt::format("{} has {} names", key, names.size()), "one to three");
    for (std::size_t i = 0; i < names.size(); ++i) {
        check_device_name(reader, key, names[i], fallback.front());
        if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]) !=
            names.begin() + static_cast<std::ptrdiff_t>(i))
            reader.fail(key, fmt::format("'{}' is there twice", names[i]));
    }
    return names;
}

}  // namespace

void check_device_name(Reader& reader, std::string_view key, const std::string& name,
                       std::string_view example) {
    constexpr std::size_t kLongest = 50;
    const bool plain = std::filesystem::path(name).lexically_normal() == name && !name.ends_with('/');
    if (!name.starts_with("/dev/") || name.size() > kLongest || !plain)
        reader.fail(key, fmt::format("'{}' is not a device", name),
                    fmt::format("a path such as {}", example));
    if (is_boards_own(name))
        reader.fail(key, fmt::format("'{}' is something else on every Linux board", name),
                    fmt::format("a path such as {}", example));
}

void read_devices(Reader& reader, LinuxBoard& board) {
    board.serial_devices = read_names(reader, "serial_devices", board.serial_devices);
    board.i2c_devices = read_names(reader, "i2c_devices", board.i2c_devices);
    for (const std::string& name : board.i2c_devices)
        if (std::find(board.serial_devices.begin(), board.serial_devices.end(), name) !=
            board.serial_devices.end())
            reader.fail("i2c_devices", fmt::format("'{}' is another device of the board", name),
                        "a path such as /dev/i2c-3");
}

void read_program(Reader& reader, LinuxBoard& board) {
    board.command = reader.texts("program");
    board.arguments = reader.texts("arguments");
    if (board.command.empty() && !reader.has("arguments"))
        reader.fail("program", "'program' is missing", "program = [\"./controller\", \"-x\"]");
    board.hostname = reader.text("hostname", board.hostname);
    board.start = reader.quantity("start", Dimension::Time, 0.0);
    if (board.start < 0) reader.fail("start", "start is before the run begins", "0 s or later");
    board.restarts = read_times(reader, "restart", board.start);
    board.folder = reader.text("folder", board.folder);
    if (const std::filesystem::path path(board.folder);
        path.is_absolute() || board.folder.find("..") != std::string::npos)
        reader.fail("folder", "folder is not below the results", "a relative path such as \"robot0\"");
    board.signals = read_signals(reader);
    board.end_signal = read_signal(reader, "end_signal", board.end_signal);
    board.grace = reader.quantity("grace", Dimension::Time, board.grace);
    if (board.grace < 0 || board.grace > kLongestGrace)
        reader.fail("grace", "grace is out of range", "0 s to 1 h");
    read_delays(reader, board.late);
    if (reader.has("clock_error")) board.clock_ppm = read_clock_error(reader, "clock_error");
}

void read_delays(Reader& reader, LinuxDelays& late) {
    constexpr double kLongest = 1.0;  // s
    const auto read = [&](const char* key, double& value, double least = 0.0) {
        value = reader.quantity(key, Dimension::Time, value);
        if (!(value >= least && value <= kLongest))
            reader.fail(key, fmt::format("{} is out of range", key),
                        fmt::format("{:g} to 1 s, such as \"4 ms\"", least));
    };
    read("tty_batch", late.tty_batch);
    read("i2c_hold", late.i2c_hold);
    read("oversleep", late.oversleep, -kLongest);
    read("oversleep_jitter", late.oversleep_jitter);
    if (reader.has("oversleep") || reader.has("oversleep_jitter")) late.oversleep_stated = true;
}

}  // namespace puckloop::scenarios
