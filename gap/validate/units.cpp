#include "gap/validate/units.h"

#include "gap/stats/robust.h"
#include "gap/stats/series.h"
#include "gap/validate/checks.h"
#include "physics/description/parameters.h"
#include "physics/sensors/proximity.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <vector>

namespace puckloop::gap {

namespace {

/// Units that are known, but nobody logs robots in.
bool rare(std::string_view unit) {
    static const std::set<std::string_view> names{"um", "in", "km", "min", "h"};
    return names.contains(unit);
}

/// The unit that somebody stated for a column; "" where nobody did.
std::string_view stated_unit(const Experiment& experiment, std::string_view column) {
    const auto place = experiment.stated.find(column);
    return place == experiment.stated.end() ? "" : std::string_view(place->second.unit);
}

/// Units other than taken in which an SI value, as the files' numbers made it, lies within low and high: the
/// nearest to their middle first.
std::vector<std::string_view> better_units(const Experiment& experiment, const ColumnInfo& info, double value,
                                           double low, double high) {
    const std::string_view stated = stated_unit(experiment, info.name);
    const ToSi taken = unit_to_si(stated.empty() ? info.unit : stated, info.unit).value_or(ToSi{});
    const auto in = [&](std::string_view unit) {
        const ToSi other = unit_to_si(unit, info.unit).value_or(ToSi{});
        return (value - taken.offset) / taken.factor * other.factor + other.offset;
    };
    std::vector<std::string_view> units = unit_names(info.unit);
    std::erase_if(units, [&](auto unit) { return rare(unit) || !(in(unit) >= low && in(unit) <= high); });
    std::ranges::stable_sort(units, {}, [&](std::string_view unit) {
        return low > 0 ? std::abs(std::log(in(unit) / low) - std::log(high / in(unit))) : 0.0;
    });
    return units;
}

/// `distance_m = "cm"`, as [columns] takes it, or with `from` where the file has another name for it.
std::string unit_line(const Experiment& experiment, std::string_view column, std::string_view unit) {
    const auto place = experiment.stated.find(column);
    if (place == experiment.stated.end() || place->second.from == column)
        return fmt::format("{} = \"{}\"", column, unit);
    return fmt::format("{} = {{ from = \"{}\", unit = \"{}\" }}", column, place->second.from, unit);
}

/// "run1.csv" or "run1.csv and 5 more files": those that have the column.
std::string files_with(const Experiment& experiment, std::string_view column) {
    std::string first;
    std::size_t more = 0;
    for (const Run& run : experiment.runs)
        if (run.has(column)) (first.empty() ? (void)(first = run.file) : (void)++more);
    return more == 0 ? first : fmt::format("{} and {} more file{}", first, more, more == 1 ? "" : "s");
}

/// The one rule of all that follows: what columns show lies outside low to high, and a unit that one of them
/// was not taken in brings it inside. What no unit puts right is the experiment's own.
void ask(Experiment& experiment, const std::vector<Factor>& factors, double found, double low, double high,
         const std::string& what) {
    if (!(found < low || found > high)) return;
    std::vector<std::string> remedies;
    for (const auto& [column, power] : factors) {
        const ColumnInfo* info = find_column(experiment.kind, column);
        if (info == nullptr || !experiment.has(column)) continue;
        const auto units = power > 0 ? better_units(experiment, *info, found, low, high)
                                     : better_units(experiment, *info, 1 / found, 1 / high, 1 / low);
        if (units.empty()) continue;
        const auto remedy = fmt::format("if the files' numbers are in {}, state {} in [columns]",
                                        units.front(), unit_line(experiment, column, units.front()));
        // Of columns at odds the one comes first whose unit somebody stated.
        remedies.insert(stated_unit(experiment, column).empty() ? remedies.end() : remedies.begin(), remedy);
    }
    if (!remedies.empty())
        experiment.caution("{}: {}: {}", files_with(experiment, factors.front().column), what,
                           fmt::join(remedies, "; or "));
}

void check_size(Experiment& experiment, const ColumnInfo& info) {
    constexpr double kNearlyAll = 0.95;  // the rest may be glitches
    const bool clock = std::string_view(info.name) == "t_s";
    std::vector<double> sizes;
    for (const Run& run : experiment.runs)
        for (const double value : clock ? stats::steps_of(run.column(info.name)) : run.column(info.name))
            if (value != 0 && std::isfinite(value)) sizes.push_back(std::abs(value));
    const double large = clock ? stats::median(sizes) : stats::quantile(sizes, kNearlyAll);
    ask(experiment, {{info.name}}, large, info.usual_low, info.usual_high,
        fmt::format("{} {} {:.3g}{}, where something from {:g} to {:g} is usual", info.name,
                    clock ? "goes on from row to row by" : "reaches", large, unit_suffix(info.unit),
                    info.usual_low, info.usual_high));
}

// ---- one column against another

constexpr double kG = 9.80665;             // m/s2
constexpr std::size_t kFewRowsOfUnit = 8;  // rows that show nothing

double at(const Run& run, std::string_view column, std::size_t row) {
    const auto& values = run.column(column);
    return values.empty() ? NAN : values[row];
}

/// From how far a white wall gives an e-puck's sensor these counts; NaN where that is hardly seen.
double seen_from(double counts) {
    constexpr double kClear = 100, kStep = 5e-4;  // counts; m
    static const physics::Parameters parameters;
    if (!(counts > kClear)) return NAN;
    double distance = 0;
    while (physics::proximity_response(parameters.proximity, distance) > counts)
        distance += kStep;
    return distance;
}

/// Columns (the first one times or over others) against what another one, row by row, lets expect of the
/// first.
template <class Expected>
void follow(Experiment& experiment, const std::vector<Factor>& factors, const char* other,
            const Expected& expected, double high = kFar) {
    constexpr double kOfPart = 0.5;  // correlation where the range is less
    const std::string& column = factors.front().column;
    Pairs pairs;
    for (const Run& run : experiment.runs)
        for (std::size_t i = 0; i < run.rows; ++i)
            pairs.add(expected(run, i), at(run, column, i));
    // A black thing behind a white one: readings change by much, but beside neither.
    for (const bool large : {false, true}) {
        const Pairs part = pairs.part(large);
        const double factor = part.factor(kOfPart);
        if (stats::varies(part.seen) && !(factor < 1 / kFar || factor > high)) return;
    }
    ask_factor(experiment, factors, other, pairs.factor(), high);
}

/// A quantity from two sides: a product of columns, maybe over time, and another column, or how much it
/// changes meanwhile. The one over the other lies between low and high.
struct Law {
    std::vector<std::string> rate;
    bool over_time;
    std::string other;
    bool changes;
    double low, high;
};

constexpr double kMostHeard = 100;  // messages a period: senders times receivers
const Law kLaws[] = {
    {{"velocity"}, true, "distance_m", true, 1 / kFar, kFar},
    {{"grey_rate", "speed"}, true, "grey", true, 1 / kFar, kFar},
    {{"acceleration"}, true, "speed", true, 1 / kFar, kFar},
    {{"speed"}, false, "motor_speed", false, 1 / kFar, kFar},
    {{}, true, "send_period", false, 1 / kMostHeard, INFINITY},  // some note a message now and then
    {{"arrival_rate", "send_period"}, false, "senders", false, 1 / kMostHeard, kMostHeard},
};

/// What moves, evenly or not, changes so from row to row, or over more rows where a clock or a ruler is too
/// coarse to show it; jumps to another place are few or of no rate.
void check_law(Experiment& experiment, const Law& law) {
    const auto value = [&](const Run& run, const std::string& column, std::size_t row) {
        if (column == "motor_speed" || (column == "speed" && !run.has("speed")))
            return at(run, "motor_speed", row) * metres_per_step(experiment);
        return at(run, column, row);
    };
    Pairs pairs;
    for (const Run& run : experiment.runs) {
        double left = 0, right = 0;
        for (std::size_t i = 1; i < run.rows; ++i) {
            double rate = 1;
            for (const std::string& column : law.rate)
                rate *= (value(run, column, i) + value(run, column, i - 1)) / 2;
            const double now = value(run, law.other, i);
            left += rate * (law.over_time ? at(run, "t_s", i) - at(run, "t_s", i - 1) : 1);
            right += law.changes ? now - value(run, law.other, i - 1) : now;
            pairs.add(right, left);
            if (rate == 0 || (left != 0 && right != 0)) left = right = 0;
        }
    }
    std::vector<Factor> factors;
    for (const std::string& column : law.rate)
        factors.push_back({column});
    if (law.over_time) factors.push_back({"t_s"});
    factors.push_back({law.other, -1});
    const double times = std::abs(pairs.ratio());
    ask(experiment, factors, times, law.low, law.high,
        fmt::format("{}{}{} is {:.3g} times {}{}", fmt::join(law.rate, " times "),
                    law.over_time && !law.rate.empty() ? " over " : "", law.over_time ? "t_s" : "", times,
                    law.changes ? "the change of " : "", law.other));
}

void check_follows(Experiment& experiment) {
    // Robots of the size have sensors that see some six times as far (Thymio).
    constexpr double kFurther = 8.0;
    follow(
        experiment, {{"distance_m"}}, "reading",
        [](const Run& run, std::size_t i) { return seen_from(at(run, "reading", i)); }, kFurther);
    const char *truth = "true_bearing_rad", *facing = "sender_bearing_rad";
    follow(experiment, {{"bearing_rad"}, {truth, -1}}, truth,
           [&](const Run& run, std::size_t i) { return at(run, truth, i); });
    for (const auto& [angle, part] : {std::pair{truth, "receiver"}, std::pair{facing, "emitter"}})
        follow(experiment, {{angle}}, part, [&, name = part](const Run& run, std::size_t i) {
            const double number = at(run, name, i);  // 1 to 12, 0: not known
            return number > 0 ? std::remainder(number - 0.5, 12) * std::numbers::pi / 6 : NAN;
        });
    const double gain = experiment.nominal_or("accelerometer.gain", 800);
    const auto felt = [&](const char* cause, const char* axis, const char* beside, double of_a_g) {
        follow(experiment, {{cause}}, axis, [&](const Run& run, std::size_t i) {
            const double other = at(run, beside, i);
            return other == 0 || std::isnan(other) ? at(run, axis, i) / gain * of_a_g : NAN;
        });
    };
    felt("pitch_rad", "ay", "acceleration", 1.0);  // small angles
    felt("roll_rad", "ax", "lateral", 1.0);
    felt("acceleration", "ay", "pitch_rad", kG);
    felt("lateral", "ax", "roll_rad", kG);
}

}  // namespace

double Pairs::factor(double together) const {
    if (seen.size() < kFewRowsOfUnit || !(std::abs(stats::correlation(expected, seen)) >= together))
        return NAN;
    return stats::standard_deviation(seen) / stats::standard_deviation(expected);
}

double Pairs::ratio() const {
    constexpr double kSame = 0.75;  // share of the rows in which both go the same way
    std::vector<double> logs;
    double same = 0;
    for (std::size_t i = 0; i < seen.size(); ++i)
        if (seen[i] != 0 && expected[i] != 0) {
            logs.push_back(std::log(std::abs(seen[i] / expected[i])));
            same += seen[i] * expected[i] > 0 ? 1 : 0;
        }
    const auto n = static_cast<double>(logs.size());
    if (logs.size() < kFewRowsOfUnit || !(std::abs(2 * same / n - 1) >= 2 * kSame - 1)) return NAN;
    const bool wide = stats::quantile(logs, 0.75) - stats::quantile(logs, 0.25) > std::log(kFar);
    return wide ? NAN : std::copysign(std::exp(stats::median(logs)), 2 * same - n);
}

double Pairs::agreement() const {
    double same = 0, all = 0;
    for (std::size_t i = 0; i < seen.size(); ++i)
        if (seen[i] != 0 && expected[i] != 0) {
            same += seen[i] * expected[i] > 0 ? 1 : 0;
            ++all;
        }
    return all == 0 ? 0.0 : std::max(same, all - same) / all;
}

Pairs Pairs::part(bool large) const {
    const double end = stats::quantile(seen, large ? 0.6 : 0.4);
    Pairs some;
    for (std::size_t i = 0; i < seen.size(); ++i)
        if (large ? seen[i] > end : seen[i] < end) some.add(expected[i], seen[i]);
    return some;
}

void ask_factor(Experiment& experiment, const std::vector<Factor>& factors, std::string_view other,
                double factor, double high) {
    ask(experiment, factors, factor, 1 / kFar, high,
        fmt::format("{} changes {:.3g} times as much as {} lets expect", factors.front().column, factor,
                    other));
}

std::string unit_remedy(const Experiment& experiment, const ColumnInfo& info, double value) {
    constexpr std::size_t kMost = 2;
    auto units = info.usual_low > 0 && std::string_view(info.name) != "t_s"
                     ? better_units(experiment, info, std::abs(value), info.usual_low, info.usual_high)
                     : better_units(experiment, info, value, info.low, info.high);
    std::string lines;
    for (const std::string_view unit : std::span(units).first(std::min(units.size(), kMost)))
        lines += fmt::format("{} numbers in {} need {} in [columns]", lines.empty() ? ";" : ",", unit,
                             unit_line(experiment, info.name, unit));
    return lines;
}

void check_units(Experiment& experiment) {
    for (const ColumnInfo& info : columns_of(experiment.kind))
        check_size(experiment, info);
    for (const Law& law : kLaws)
        check_law(experiment, law);
    check_follows(experiment);
}

}  // namespace puckloop::gap
