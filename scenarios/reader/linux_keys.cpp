#include "scenarios/reader/linux_keys.h"

#include "scenarios/reader/board_keys.h"

#include <fmt/format.h>

#include <csignal>
#include <cstring>

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

}  // namespace

void read_program(Reader& reader, LinuxBoard& board) {
    board.command = reader.texts("program");
    board.arguments = reader.texts("arguments");
    if (board.command.empty() && board.arguments.empty())
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
}

}  // namespace puckloop::scenarios
