#include "gap/validate/units.h"

#include "gap/stats/robust.h"
#include "gap/validate/checks.h"
#include "physics/description/robot_constants.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

namespace puckloop::gap {

namespace {

constexpr double kNear = 5.0;      // factor between what a unit makes of a number and what is expected
constexpr double kNothing = 1e-6;  // of the least usual value: rounding of a zero
constexpr double kNoLimit = 1e300;

/// Sizes that a column usually has; SI units.
struct Usual {
    Kind kind;
    std::string_view column;
    double least;     ///< the largest value is at least this, if not zero
    double smallest;  ///< the smallest is at most this
    double largest;   ///< and the largest at most this
    double typical;   ///< the largest, in the middle of what is usual
};

/// Proximity: seen to 0.1 m, nothing beyond 0.3 m (e-puck facts 5.1). Range and bearing: heard to 0.8 m, in
/// published sets to 6 m; frames of 4.5 and 9.2 ms. An edge of a printed floor under a spot of millimetres:
/// up to some 1000 / m. The e-puck drives 0.13 m/s, weighs 0.2 kg and has one cell of 3.4 to 4.2 V.
constexpr Usual kUsual[] = {
    {Kind::Proximity, "distance_m", 1e-3, 0.3, kNoLimit, 0.08},
    {Kind::Proximity, "velocity", 2e-4, kNoLimit, 0.5, 0.1},
    {Kind::Rab, "distance_m", 0.02, 3.0, 8.0, 0.5},
    {Kind::Rab, "frame_time", 3e-4, kNoLimit, 0.1, 0.006},
    {Kind::Rab, "send_period", 1e-3, 10.0, kNoLimit, 0.05},
    {Kind::Rab, "poll_period", 1e-3, 10.0, kNoLimit, 0.05},
    {Kind::Rab, "arrival_rate", 0.3, kNoLimit, 1000.0, 50.0},
    {Kind::Microphone, "distance_m", 0.01, 3.0, kNoLimit, 0.5},
    {Kind::Ground, "grey_rate", 0.2, kNoLimit, 3000.0, 50.0},
    {Kind::Motion, "load_kg", 2e-3, kNoLimit, 5.0, 0.2},
};
constexpr Usual kUsualOfAll[] = {
    {Kind::Motion, "temperature_c", 0.0, 50.0, kNoLimit, 22.0},
    {Kind::Motion, "battery_v", 1.0, 15.0, kNoLimit, 4.0},
    {Kind::Motion, "speed", 2e-4, kNoLimit, 2.0, 0.1},
};

const Usual* usual_of(Kind kind, std::string_view column) {
    for (const Usual& usual : kUsual)
        if (usual.kind == kind && usual.column == column) return &usual;
    for (const Usual& usual : kUsualOfAll)
        if (usual.column == column) return &usual;
    return nullptr;
}

/// Units that are known, but nobody logs robots in.
bool rare(std::string_view unit) {
    static const std::set<std::string_view> names{"um", "in", "km", "ns", "min", "h"};
    return names.contains(unit);
}

const Stated& stated_of(const Experiment& experiment, const ColumnInfo& info) {
    static const Stated none;
    const auto place = experiment.stated.find(info.name);
    return place == experiment.stated.end() ? none : place->second;
}

std::string_view unit_of(const Stated& stated, const ColumnInfo& info) {
    return stated.unit.empty() ? info.unit : std::string_view(stated.unit);
}

/// An SI value as it would be, were the files' numbers in `unit`.
double in_unit(const Experiment& experiment, const ColumnInfo& info, double value, std::string_view unit) {
    const ToSi taken = unit_to_si(unit_of(stated_of(experiment, info), info), info.unit).value_or(ToSi{}),
               other = unit_to_si(unit, info.unit).value_or(ToSi{});
    return (value - taken.offset) / taken.factor * other.factor + other.offset;
}

stats::Range sizes_of(const Experiment& experiment, std::string_view column) {
    stats::Range sizes;
    for (const Run& run : experiment.runs) {
        std::vector<double> all = run.column(column);
        for (double& value : all)
            value = std::abs(value);
        sizes.take(all);
    }
    return sizes;
}

/// `distance_m = "cm"`, as [columns] takes it, or with `from` where the file has another name for it.
std::string unit_line(const Experiment& experiment, std::string_view column, std::string_view unit) {
    const auto place = experiment.stated.find(column);
    if (place == experiment.stated.end() || place->second.from == column)
        return fmt::format("{} = \"{}\"", column, unit);
    return fmt::format("{} = {{ from = \"{}\", unit = \"{}\" }}", column, place->second.from, unit);
}

/// What a caution about one column ends with; `unit` is the likely one, or empty.
std::string remedy(const Experiment& experiment, const ColumnInfo& info, std::string_view unit) {
    return unit.empty() ? "is its unit right?" : to_state(experiment, {info.name}, unit);
}

void check_size(Experiment& experiment, const ColumnInfo& info) {
    const Usual* usual = usual_of(experiment.kind, info.name);
    if (usual == nullptr || !experiment.has(info.name)) return;
    const stats::Range sizes = sizes_of(experiment, info.name);
    const bool small = sizes.high > kNothing * usual->least && sizes.high < usual->least;
    const bool large = sizes.low > usual->smallest || sizes.high > usual->largest;
    if (sizes.empty() || !(small || large)) return;
    const std::string suffix = unit_suffix(info.unit);
    const std::string wanted =
        small ? fmt::format("usually it reaches {:g}{} or more", usual->least, suffix)
        : sizes.low > usual->smallest
            ? fmt::format("usually some of it is {:g}{} or less", usual->smallest, suffix)
            : fmt::format("usually it is at most {:g}{}", usual->largest, suffix);
    const auto range = experiment.range(info.name);
    experiment.caution("{}: {} is {:.3g} to {:.3g}{}; {}: {}", files_with(experiment, info.name), info.name,
                       range.low, range.high, suffix, wanted,
                       remedy(experiment, info, likely_unit(experiment, info, sizes.high, usual->typical)));
}

/// A run is done in one go, on one battery.
void check_duration(Experiment& experiment) {
    constexpr double kDay = 86400, kUsualStep = 0.1;  // s
    double longest = 0.0;
    for (const Run& run : experiment.runs) {
        stats::Range times;
        times.take(run.column("t_s"));
        if (!times.empty()) longest = std::max(longest, times.high - times.low);
    }
    if (longest <= kDay) return;
    std::vector<double> steps;
    for (const Run& run : experiment.runs)
        for (const double step : stats::steps_of(run.column("t_s")))
            if (step > 0) steps.push_back(step);
    const ColumnInfo& info = *find_column(experiment.kind, "t_s");
    experiment.caution(
        "{}: t_s goes on for {:.3g} s, which is {:.1f} days in one run: {}", files_with(experiment, "t_s"),
        longest, longest / kDay,
        remedy(experiment, info, likely_unit(experiment, info, stats::upper_median(steps), kUsualStep)));
}

// ---- one column against another

/// Of y over x by least squares; NaN where they hardly go together.
double slope(const std::vector<double>& x, const std::vector<double>& y) {
    constexpr std::size_t kFew = 8;
    constexpr double kTogether = 0.7;
    std::vector<double> a, b;
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i)
        if (std::isfinite(x[i] + y[i])) a.push_back(x[i]), b.push_back(y[i]);
    if (a.size() < kFew) return NAN;
    const double together = stats::correlation(a, b);
    if (std::abs(together) < kTogether) return NAN;
    return together * stats::standard_deviation(b) / stats::standard_deviation(a);
}

/// A caution where `info` is `ratio` times what the other column makes of it.
void caution_ratio(Experiment& experiment, std::string_view column, double ratio, const std::string& what) {
    constexpr double kFar = 3.0;
    if (!(ratio > kFar) && !(ratio < 1 / kFar)) return;
    const ColumnInfo& info = *find_column(experiment.kind, column);
    experiment.caution("{}: {}: {}", files_with(experiment, column), what,
                       remedy(experiment, info, likely_unit(experiment, info, ratio, 1.0)));
}

/// A bearing that follows the true one, by far more or less.
void check_bearings(Experiment& experiment) {
    if (!experiment.has("bearing_rad")) return;
    const auto bearing = pooled(experiment, "bearing_rad"), truth = pooled(experiment, "true_bearing_rad");
    const double ratio = slope(truth, bearing);
    if (!(ratio > 0)) return;
    const bool of_truth =
        sizes_of(experiment, "true_bearing_rad").high < sizes_of(experiment, "bearing_rad").high;
    caution_ratio(experiment, of_truth ? "true_bearing_rad" : "bearing_rad", of_truth ? 1 / ratio : ratio,
                  fmt::format("bearing_rad changes {:.3g} times as much as true_bearing_rad", ratio));
}

/// The receivers stand 30 degrees apart: those nearest to the sender give the true bearing's range.
void check_receivers(Experiment& experiment) {
    constexpr double kApart = 2 * std::numbers::pi / 12;
    constexpr std::size_t kFewest = 4;
    if (!experiment.has("true_bearing_rad")) return;
    const auto receivers = pooled(experiment, "receiver"), truth = pooled(experiment, "true_bearing_rad");
    std::set<double> some;
    for (std::size_t i = 0; i < truth.size(); ++i)
        if (!std::isnan(receivers[i] + truth[i]) && receivers[i] > 0) some.insert(receivers[i]);
    if (some.size() < kFewest) return;
    const stats::Range range = experiment.range("true_bearing_rad");
    const double least = static_cast<double>(some.size() - 2) * kApart;  // the outermost only just
    caution_ratio(experiment, "true_bearing_rad", std::min((range.high - range.low) / least, 1.0),
                  fmt::format("true_bearing_rad is {:.3g} to {:.3g} rad where {} different receivers are "
                              "nearest to the sender, which lie 0.52 rad apart",
                              range.low, range.high, some.size()));
}

/// What an axis of the accelerometer should feel, g, where nothing else than `cause` acts on it; else NaN.
std::vector<double> felt_alone(const Experiment& experiment, const char* cause, const char* other,
                               bool tilt) {
    constexpr double kG = 9.80665;
    std::vector<double> values = pooled(experiment, cause);
    const std::vector<double> beside = pooled(experiment, other);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = beside[i] != 0.0 && !std::isnan(beside[i]) ? NAN
                    : tilt                                     ? std::sin(values[i])
                                                               : values[i] / kG;
    return values;
}

/// An axis of the accelerometer follows its tilt by the sine, and a push by its g.
void check_tilts(Experiment& experiment) {
    struct Felt {
        const char *axis, *cause, *other;
        bool tilt;
    };
    const double gain = experiment.nominal_or("accelerometer.gain", 800);
    for (const Felt& felt :
         {Felt{"ay", "pitch_rad", "acceleration", true}, Felt{"ay", "acceleration", "pitch_rad", false},
          Felt{"ax", "roll_rad", "lateral", true}, Felt{"ax", "lateral", "roll_rad", false}}) {
        const double ratio = std::abs(slope(felt_alone(experiment, felt.cause, felt.other, felt.tilt),
                                            pooled(experiment, felt.axis))) /
                             gain;
        if (std::isnan(ratio)) continue;
        caution_ratio(experiment, felt.cause, 1 / ratio,
                      fmt::format("{} changes by {:.4g} counts a g by {}, not by some {:g}", felt.axis,
                                  ratio * gain, felt.cause, gain));
    }
}

/// Readings that differ much where the sensors see nothing, or next to nothing where they fall steeply.
void check_reach(Experiment& experiment) {
    constexpr double kSeesNothing = 0.15, kContact = 0.0025;  // m
    constexpr double kMuch = 500;                             // counts: 18 come back from 0.15 m
    constexpr double kSteep = 10.0, kClear = 100.0;           // factor between readings; counts
    std::vector<double> far, near;
    const auto distance = pooled(experiment, "distance_m"), reading = pooled(experiment, "reading");
    for (std::size_t i = 0; i < distance.size(); ++i) {
        if (std::isnan(distance[i] + reading[i])) continue;
        (distance[i] > kSeesNothing ? far : near).push_back(reading[i]);
    }
    const stats::Range range = experiment.range("distance_m");
    const auto spread = [](const std::vector<double>& all, double high, double low) {
        return std::pair(stats::quantile(all, high), stats::quantile(all, low));
    };
    const ColumnInfo& info = *find_column(experiment.kind, "distance_m");
    const auto [most, least] = spread(far, 0.95, 0.05);
    if (far.size() > near.size() && most - least > kMuch &&
        range.low <= usual_of(experiment.kind, info.name)->smallest)
        experiment.caution(
            "{}: distance_m is {:.3g} to {:.3g} m, and beyond {:g} m, where an e-puck's sensors "
            "see next to nothing, readings differ by {:.0f} counts: {}",
            files_with(experiment, info.name), range.low, range.high, kSeesNothing, most - least,
            remedy(experiment, info, likely_unit(experiment, info, range.high, 0.08)));
    const auto [bright, dim] = spread(near, 0.95, 0.05);
    if (far.empty() && range.high < kContact && range.high >= usual_of(experiment.kind, info.name)->least &&
        bright > kClear && dim < bright / kSteep)
        experiment.caution(
            "{}: distance_m is {:.3g} to {:.3g} m, all of it next to contact, and yet readings "
            "fall from {:.0f} to {:.0f} counts: {}",
            files_with(experiment, info.name), range.low, range.high, bright, dim,
            remedy(experiment, info, likely_unit(experiment, info, range.high, 0.08)));
}

}  // namespace

std::string files_with(const Experiment& experiment, std::string_view column) {
    std::string first;
    std::size_t more = 0;
    for (const Run& run : experiment.runs)
        if (run.has(column)) (first.empty() ? (void)(first = run.file) : (void)++more);
    return more == 0 ? first : fmt::format("{} and {} more file{}", first, more, more == 1 ? "" : "s");
}

std::string_view likely_unit(const Experiment& experiment, const ColumnInfo& info, double found,
                             double expected) {
    const auto off = [&](std::string_view unit) {
        const double size = in_unit(experiment, info, found, unit);
        return size > 0 ? std::abs(std::log(size / expected)) : kNoLimit;
    };
    const std::string_view taken = unit_of(stated_of(experiment, info), info);
    std::string_view best;
    double least = std::min(std::log(kNear), off(taken));
    for (const std::string_view unit : unit_names(info.unit))
        if (unit != taken && !rare(unit) && off(unit) < least) best = unit, least = off(unit);
    return best;
}

std::string to_state(const Experiment& experiment, const std::vector<std::string_view>& columns,
                     std::string_view unit) {
    std::vector<std::string> lines;
    for (const std::string_view column : columns)
        lines.push_back(unit_line(experiment, column, unit));
    return fmt::format("if the files' numbers are in {}, state {} in [columns]", unit,
                       fmt::join(lines, ", "));
}

std::string unit_remedy(const Experiment& experiment, const ColumnInfo& info, double value) {
    std::vector<std::string> lines;
    const auto line = [&](std::string_view unit) {
        lines.push_back(
            fmt::format("numbers in {} need {} in [columns]", unit, unit_line(experiment, info.name, unit)));
    };
    if (const Usual* usual = usual_of(experiment.kind, info.name)) {
        const auto unit = likely_unit(experiment, info, std::abs(value), usual->typical);
        if (!unit.empty()) line(unit);
    } else {
        for (const std::string_view unit : unit_names(info.unit)) {
            const double other = in_unit(experiment, info, value, unit);
            if (!rare(unit) && other >= info.low && other <= info.high && lines.size() < 2) line(unit);
        }
    }
    return lines.empty() ? "" : fmt::format("; {}", fmt::join(lines, ", "));
}

void check_units(Experiment& experiment) {
    for (const ColumnInfo& info : columns_of(experiment.kind))
        check_size(experiment, info);
    check_duration(experiment);
    switch (experiment.kind) {
    case Kind::Proximity:
        return check_reach(experiment);
    case Kind::Motion:
        return check_motion_units(experiment);
    case Kind::Rab:
        check_bearings(experiment);
        return check_receivers(experiment);
    case Kind::Accelerometer:
        return check_tilts(experiment);
    case Kind::Microphone:
    case Kind::Ground:
    case Kind::Timing:  // a wrong unit of a clock is refused
        return;
    }
}

}  // namespace puckloop::gap
