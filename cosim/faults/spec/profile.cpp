#include "cosim/faults/spec/profile.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string>

namespace puckloop::cosim {

namespace {

constexpr std::size_t kMostPoints = 1000;
constexpr double kLatest = 1e6;  // s
constexpr std::string_view kBlanks = " \t\n";

struct UnitName {
    std::string_view name;
    double factor;
};

[[noreturn]] void refuse(const std::string& problem) {
    throw InputError("", "profile", problem, "times and volts, such as 0 s 4.1 V, 90 s 3.6 V");
}

void skip_blanks(std::string_view& text) {
    text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
}

/// A number and its unit, if it has one, from the front of `text`.
double take(std::string_view& text, std::initializer_list<UnitName> units) {
    skip_blanks(text);
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc()) refuse(fmt::format("no number at '{}'", text));
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    skip_blanks(text);
    for (const UnitName& unit : units)
        if (text.starts_with(unit.name)) {
            text.remove_prefix(unit.name.size());
            return value * unit.factor;
        }
    return value;
}

}  // namespace

std::vector<ProfilePoint> voltage_profile(std::string_view text, double most) {
    constexpr double kMinute = 60, kThousandth = 1e-3;
    std::vector<ProfilePoint> points;
    while (true) {
        if (points.size() == kMostPoints) refuse(fmt::format("more than {} points", kMostPoints));
        const double seconds = take(text, {{"ms", kThousandth}, {"min", kMinute}, {"s", 1}});
        const double volts = take(text, {{"mV", kThousandth}, {"V", 1}});
        if (!(seconds >= 0 && seconds <= kLatest)) refuse(fmt::format("a time of {:g} s", seconds));
        if (!(volts >= 0 && volts <= most)) refuse(fmt::format("a voltage of {:g} V", volts));
        const Time time = from_seconds(seconds);
        if (!points.empty() && time <= points.back().time) refuse("times do not rise");
        points.push_back({time, volts});
        skip_blanks(text);
        if (text.empty()) return points;
        if (text[0] != ',' && text[0] != ';') refuse(fmt::format("what is '{}'", text));
        text.remove_prefix(1);
    }
}

double value_at(const std::vector<ProfilePoint>& profile, Time time) {
    const auto after =
        std::upper_bound(profile.begin(), profile.end(), time,
                         [](Time when, const ProfilePoint& point) { return when < point.time; });
    if (after == profile.begin()) return profile.front().value;
    if (after == profile.end()) return profile.back().value;
    const ProfilePoint& before = *(after - 1);
    return before.value + (after->value - before.value) * to_seconds(time - before.time) /
                              to_seconds(after->time - before.time);
}

}  // namespace puckloop::cosim
