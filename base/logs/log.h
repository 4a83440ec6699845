#pragma once
// What puckloop reports of its own work on the host: processes, files, timings. Logs in simulated time are
// base/logs/node_log.h. One line an entry, from any process or thread, whole:
//   2026-03-01 09:30:00.123 info    [robot0.pic 4711] firmware epuck.hex: 21034 words
// Nothing is said unless the user asks (-v, --log-level, --log-file).

#include <fmt/core.h>

#include <string>
#include <string_view>

namespace puckloop::log {

enum class Level { Trace, Debug, Info, Warning, Error, Off };

struct Settings {
    Level level = Level::Off;
    std::string file{};  ///< appended to; empty: standard error
};

/// The level of that name ("trace" to "off"). InputError names option `--log-level`.
Level level_named(const std::string& name);

/// Begins the log of this process, `name` in its lines. InputError if the file cannot be opened.
void start(const std::string& name, const Settings& settings);

/// Processes that are started from now on continue this log under names of their own (start_in_child), by a
/// variable in their environment.
void share_with_children();

/// In a process that was started so: takes the variable out of the environment, where nobody else is to see
/// it. A log that cannot be opened any more is left out.
void start_in_child(const std::string& name);

bool wants(Level level);
void write(Level level, std::string_view text);

template <typename... Values>
void say(Level level, fmt::format_string<Values...> format, Values&&... values) {
    if (wants(level)) write(level, fmt::vformat(format, fmt::make_format_args(values...)));
}
template <typename... Values>
void debug(fmt::format_string<Values...> format, Values&&... values) {
    say<Values...>(Level::Debug, format, std::forward<Values>(values)...);
}
template <typename... Values>
void info(fmt::format_string<Values...> format, Values&&... values) {
    say<Values...>(Level::Info, format, std::forward<Values>(values)...);
}
template <typename... Values>
void warning(fmt::format_string<Values...> format, Values&&... values) {
    say<Values...>(Level::Warning, format, std::forward<Values>(values)...);
}

}  // namespace puckloop::log
