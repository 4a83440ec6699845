#include "tools/cli/time_check.h"

#include "tools/cli/shown_word.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

namespace puckloop::tools {

namespace {

/// Seconds of "5 s", "500 ms" or "5"; nothing: it is no time.
std::optional<double> seconds_of(std::string_view text) {
    constexpr std::pair<std::string_view, double> kUnits[] = {{"", 1.0},    {"s", 1.0},    {"ms", 1e-3},
                                                              {"us", 1e-6}, {"min", 60.0}, {"h", 3600.0}};
    double value = 0.0;
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, value);
    if (error != std::errc{}) return std::nullopt;
    std::string_view unit(end, static_cast<std::size_t>(last - end));
    while (!unit.empty() && unit.front() == ' ')
        unit.remove_prefix(1);
    for (const auto& [name, seconds] : kUnits)
        if (unit == name) return value * seconds;
    return std::nullopt;
}

}  // namespace

Check seconds_between(double low, double high) {
    return {[low, high](const std::string& text) {
                const std::optional<double> seconds = seconds_of(text);
                return seconds && *seconds >= low && *seconds <= high
                           ? std::string()
                           : fmt::format("'{}' is not a time from {:g} to {:g} s", shown_word(text), low,
                                         high);
            },
            kTimeShown};
}

std::string seconds_text(const std::string& text) {
    return fmt::format("{}", seconds_of(text).value_or(0.0));
}

}  // namespace puckloop::tools
