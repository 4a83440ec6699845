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

/// What a column's largest size usually is, SI units.
struct Usual {
    std::optional<Kind> kind;  ///< nothing: any
    std::string_view column;
    double low, high;
};

/// Range and bearing: heard to 0.8 m, in published sets to 6 m; frames of 4.5 and 9.2 ms. An edge of a
/// printed floor under a spot of millimetres: up to some 1000 / m. The e-puck drives 0.13 m/s, weighs 0.2 kg
/// and has one cell of 3.4 to 4.2 V. No angle that matters lies below 1.6 degrees, a whole circle's half
/// below 3.
constexpr Usual kUsual[] = {
    {Kind::Proximity, "distance_m", 2e-4, 1.0},   {Kind::Rab, "distance_m", 0.02, 10.0},
    {Kind::Rab, "frame_time", 3e-4, 0.1},         {Kind::Rab, "send_period", 1e-3, 100.0},
    {Kind::Microphone, "distance_m", 0.01, 10.0}, {Kind::Ground, "grey_rate", 1e-3, 3000.0},
    {Kind::Proximity, "angle_rad", 0.028, 1.6},   {Kind::Microphone, "angle_rad", 0.055, 7.0},
    {Kind::Motion, "load_kg", 1e-3, 5.0},         {std::nullopt, "battery_v", 1.0, 15.0},
    {std::nullopt, "speed", 1e-4, 4.0},
};

const Usual* usual_of(Kind kind, std::string_view column) {
    const auto* const found = std::ranges::find_if(
        kUsual, [&](const Usual& one) { return one.kind.value_or(kind) == kind && one.column == column; });
    return found == std::end(kUsual) ? nullptr : found;
}

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

/// The one rule of all that follows: what a column shows lies outside low to high, and a unit that the column
/// was not taken in brings it inside. What no unit puts right is the experiment's own.
bool ask(Experiment& experiment, std::string_view column, double found, double low, double high,
         const std::string& what) {
    if (!(found < low || found > high)) return false;
    const auto units = better_units(experiment, *find_column(experiment.kind, column), found, low, high);
    if (units.empty()) return false;
    experiment.caution("{}: {}: if the files' numbers are in {}, state {} in [columns]",
                       files_with(experiment, column), what, units.front(),
                       unit_line(experiment, column, units.front()));
    return true;
}

void check_size(Experiment& experiment, const ColumnInfo& info) {
    constexpr double kNearlyAll = 0.95;  // the rest may be glitches
    const Usual* usual = usual_of(experiment.kind, info.name);
    if (usual == nullptr) return;
    std::vector<double> sizes = pooled(experiment, info.name);
    std::erase_if(sizes, [](double value) { return value == 0 || std::isnan(value); });
    for (double& value : sizes)
        value = std::abs(value);
    const double large = stats::quantile(sizes, kNearlyAll);
    ask(experiment, info.name, large, usual->low, usual->high,
        fmt::format("{} reaches {:.3g}{}, where something from {:g} to {:g} is usual", info.name, large,
                    unit_suffix(info.unit), usual->low, usual->high));
}

/// A run is done in one go, on one battery; and messages do not come oftener than they are sent.
void check_times(Experiment& experiment) {
    constexpr double kMoment = 0.01, kDay = 86400;  // s
    constexpr double kMostHeard = 100;              // rows a period: senders times receivers
    double longest = 0, span = 0, rows = 0;
    for (const Run& run : experiment.runs) {
        stats::Range times;
        times.take(run.column("t_s"));
        if (times.empty()) continue;
        longest = std::max(longest, times.high - times.low);
        span += times.high - times.low, rows += static_cast<double>(run.rows);
    }
    if (longest > 0)
        ask(experiment, "t_s", longest, kMoment, kDay,
            fmt::format("t_s goes on for {:.3g} s, which is {:.2g} days, in one run", longest,
                        longest / kDay));
    const double heard = stats::median(pooled(experiment, "send_period")) * rows / span;
    if (experiment.has("send_period") && heard > 1)
        ask(experiment, "send_period", heard, 1 / kMostHeard, kMostHeard,
            fmt::format("in one send_period {:.3g} messages come by t_s", heard));
}

// ---- one column against another

constexpr double kG = 9.80665;  // m/s2

double at(const Run& run, const char* column, std::size_t row) {
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

/// A column against what another one, row by row, lets expect of it.
template <class Expected>
void follow(Experiment& experiment, const char* column, const char* other, const Expected& expected,
            double high = kFar) {
    constexpr double kOfPart = 0.5;  // correlation where the range is less
    // Of two columns at odds the one is asked whose unit somebody stated.
    if (!experiment.has(column) ||
        (!stated_unit(experiment, other).empty() && stated_unit(experiment, column).empty()))
        return;
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
    ask_factor(experiment, column, other, pairs, high);
}

void check_follows(Experiment& experiment) {
    // Robots of the size have sensors that see some six times as far (Thymio).
    constexpr double kFurther = 8.0;
    follow(
        experiment, "distance_m", "reading",
        [](const Run& run, std::size_t i) { return seen_from(at(run, "reading", i)); }, kFurther);
    follow(experiment, "velocity", "distance_m over t_s", [](const Run& run, std::size_t i) {
        const auto step = [&](const char* column) { return at(run, column, i) - at(run, column, i - 1); };
        return i == 0 ? NAN : step("distance_m") / step("t_s");
    });
    const char *bearing = "bearing_rad", *truth = "true_bearing_rad";
    follow(experiment, bearing, truth, [&](const Run& run, std::size_t i) { return at(run, truth, i); });
    follow(experiment, truth, bearing, [&](const Run& run, std::size_t i) { return at(run, bearing, i); });
    follow(experiment, truth, "receiver", [](const Run& run, std::size_t i) {
        const double receiver = at(run, "receiver", i);  // 1 to 12, 0: not known
        return receiver > 0 ? std::remainder(receiver - 0.5, 12) * std::numbers::pi / 6 : NAN;
    });
    const double gain = experiment.nominal_or("accelerometer.gain", 800);
    const auto felt = [&](const char* cause, const char* axis, const char* beside, double of_a_g) {
        follow(experiment, cause, axis, [&](const Run& run, std::size_t i) {
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
    constexpr std::size_t kFew = 8;
    if (seen.size() < kFew || !(std::abs(stats::correlation(expected, seen)) >= together)) return NAN;
    return stats::standard_deviation(seen) / stats::standard_deviation(expected);
}

Pairs Pairs::part(bool large) const {
    const double end = stats::quantile(seen, large ? 0.6 : 0.4);
    Pairs some;
    for (std::size_t i = 0; i < seen.size(); ++i)
        if (large ? seen[i] > end : seen[i] < end) some.add(expected[i], seen[i]);
    return some;
}

void ask_factor(Experiment& experiment, std::string_view column, std::string_view other, const Pairs& pairs,
                double high) {
    const double factor = pairs.factor();
    ask(experiment, column, factor, 1 / kFar, high,
        fmt::format("{} changes {:.3g} times as much as {} lets expect", column, factor, other));
}

std::string unit_remedy(const Experiment& experiment, const ColumnInfo& info, double value) {
    constexpr std::size_t kMost = 2;
    const Usual* usual = usual_of(experiment.kind, info.name);
    auto units = usual != nullptr ? better_units(experiment, info, std::abs(value), usual->low, usual->high)
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
    check_times(experiment);
    check_follows(experiment);
}

}  // namespace puckloop::gap
