#include "gap/validate/checks.h"

#include "gap/stats/robust.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr std::size_t kFew = 8;  // rows that say nothing

/// Of two columns, or of their ranks, over rows where both are there; 0 when there are few.
double correlation(const std::vector<double>& a, const std::vector<double>& b, bool of_ranks = false) {
    std::vector<double> x, y;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        if (!std::isnan(a[i] + b[i])) x.push_back(a[i]), y.push_back(b[i]);
    if (x.size() < kFew) return 0.0;
    return of_ranks ? stats::correlation(stats::ranks(x), stats::ranks(y)) : stats::correlation(x, y);
}
double rank_correlation(const std::vector<double>& a, const std::vector<double>& b) {
    return correlation(a, b, true);
}

/// Do some runs correlate clearly in this direction, and none the other way? In one run among others that is
/// a finding, in all of them an exchange of columns or signs.
template <class Correlation>
bool contrary(const std::vector<Run>& runs, const Correlation& of) {
    constexpr double kClear = 0.65, kNone = -0.3;
    bool some = false;
    for (const Run& run : runs) {
        const double correlation = of(run);
        if (correlation < kNone) return false;
        some = some || correlation > kClear;
    }
    return some;
}

/// A reflective sensor sees more when the wall is nearer; the other way round the columns are exchanged or
/// the reading has the wrong sign.
void check_proximity(Experiment& experiment) {
    const std::vector<double> readings = pooled(experiment, "reading");
    const double correlation = rank_correlation(pooled(experiment, "distance_m"), readings);
    if (correlation > 0.5)
        refuse(experiment, experiment.runs.front(),
               fmt::format("reading grows with distance_m (rank correlation {:.2f}): columns swapped, or "
                           "ambient counts instead of ambient minus lit",
                           correlation),
               "readings that fall with distance");
    std::vector<double> angles = pooled(experiment, "angle_rad");
    for (double& angle : angles)
        angle = std::abs(angle);
    if (std::abs(correlation) < 0.3 && rank_correlation(angles, readings) < -0.85)
        experiment.cautions.emplace_back(
            "readings fall with angle_rad and not with distance_m: are the two columns swapped?");
}

/// What the rear axis should feel, from the truth columns; the right axis likewise.
std::vector<double> felt(const Run& run, const char* tilt, const char* push, double sign) {
    const auto &angle = run.column(tilt), &force = run.column(push);
    std::vector<double> out;
    for (std::size_t i = 0; i < run.rows; ++i) {
        const double a = angle.empty() ? 0.0 : angle[i], f = force.empty() ? 0.0 : force[i];
        out.push_back(sign * (std::sin(a) + f * std::cos(a) / 9.81));
    }
    return out;
}

/// Intervals between rows.
struct Pace {
    double median = 0.0, mean = 0.0;      ///< s; 0 where there are few
    double scatter = 0.0, strayed = 0.0;  ///< robust sd, and mean distance from the median
};

Pace pace(const std::vector<double>& times) {
    std::vector<double> steps = stats::steps_of(times);
    if (steps.size() < kFew) return {};
    Pace pace{stats::upper_median(steps), stats::mean(steps)};
    for (double& step : steps)
        step = std::abs(step - pace.median);
    pace.scatter = stats::kMadToSigma * stats::upper_median(steps);
    pace.strayed = stats::mean(steps);
    return pace;
}

/// Batches move the median and gaps the mean: a wrong unit moves both.
bool differ(const Pace& a, const Pace& b, double factor) {
    const auto off = [factor](double x, double y) { return x > factor * y || y > factor * x; };
    return a.mean > 0 && b.mean > 0 && off(a.mean, b.mean) && off(a.median, b.median);
}

void check_timing(Experiment& experiment) {
    constexpr double kDefaultPeriod = 0.1, kClocks = 3.0, kPeriods = 20.0;
    for (const Run& run : experiment.runs) {
        const Pace host = pace(run.column("t_host_s")), robot = pace(run.column("t_robot_s"));
        if (differ(host, robot, kClocks))
            refuse(
                experiment, run,
                fmt::format("a frame takes {:.4g} s by t_host_s and {:.4g} s by t_robot_s: wrong unit of one",
                            host.mean, robot.mean),
                "clocks that agree within a factor of three");
        const auto& given = run.column("nominal_period");
        const double period = given.empty() || std::isnan(given.front()) ? kDefaultPeriod : given.front();
        if (differ(host, {period, period, 0.0}, kPeriods))
            refuse(experiment, run,
                   fmt::format("a frame takes {:.4g} s where nominal_period is {:.4g} s{}", host.mean, period,
                               given.empty() ? " (not given)" : ""),
                   "times in seconds, and the loop's nominal_period");
        // The host sees the robot's jitter and adds its own; the other way round, the columns are. Handed
        // over in batches, most intervals are alike, but the few others stray as far together.
        if (robot.scatter > 3 * host.scatter && robot.strayed > 3 * host.strayed && robot.scatter > 1e-6)
            refuse(experiment, run, "t_robot_s is more irregular than t_host_s: swapped columns",
                   "the host's clock in t_host_s");
    }
}

void check_microphone(Experiment& experiment) {
    for (const Run& run : experiment.runs)
        if (rank_correlation(run.column("distance_m"), run.column("level")) > 0.8)
            refuse(experiment, run, "level grows with distance_m: swapped columns",
                   "levels that fall with distance");
}

void check_ground(Experiment& experiment) {
    for (const Run& run : experiment.runs)
        if (rank_correlation(run.column("grey"), run.column("reading")) < -0.5)
            refuse(experiment, run,
                   "reading falls where the floor is lighter: swapped columns, or grey counted from white",
                   "0 black, 1 white");
}

void check_accelerometer(Experiment& experiment) {
    const double zero = experiment.nominal_or("accelerometer.zero", 2048),
                 gain = experiment.nominal_or("accelerometer.gain", 800);
    for (const Run& run : experiment.runs) {
        const double up = (stats::mean(run.column("az")) - zero) / gain;
        if (up < 0.2 || up > 3.0)
            refuse(experiment, run,
                   fmt::format("az is {:.2f} g on average: axes swapped, or accelerometer.zero and gain of "
                               "another sensor",
                               up),
                   "about 1 g; say accelerometer.zero and accelerometer.gain in [nominal]");
        constexpr double kClear = 0.7, kNone = 0.3;
        const auto rear = felt(run, "pitch_rad", "acceleration", -1.0);
        const double own = correlation(run.column("ay"), rear), other = correlation(run.column("ax"), rear);
        if (std::abs(other) > kClear && std::abs(own) < kNone)
            refuse(experiment, run, "ax follows pitch and forward acceleration, ay does not: axes swapped",
                   "ax to the right, ay to the rear");
    }
    const auto against = [](const char* axis, const char* tilt, const char* push) {
        return [=](const Run& run) { return correlation(run.column(axis), felt(run, tilt, push, 1.0)); };
    };
    if (contrary(experiment.runs, against("ay", "pitch_rad", "acceleration")) ||
        contrary(experiment.runs, against("ax", "roll_rad", "lateral")))
        refuse(experiment, experiment.runs.front(), "an axis has the wrong sign",
               "ax to the right, ay to the rear, az up");
}

/// How well one bearing follows the other, or the other's mirror image: mean vectors of their difference, so
/// that an offset counts for nothing.
double follows(const std::vector<double>& bearing, const std::vector<double>& truth, double sign) {
    double c = 0, s = 0, n = 0;
    for (std::size_t i = 0; i < std::min(bearing.size(), truth.size()); ++i) {
        const double off = bearing[i] - sign * truth[i];
        if (std::isnan(off)) continue;
        c += std::cos(off), s += std::sin(off), n += 1;
    }
    return n < 8 ? 0.0 : std::hypot(c, s) / n;
}

void check_rab(Experiment& experiment) {
    if (!experiment.has("strength") && !experiment.has("bearing_rad") && !experiment.has("received"))
        refuse(experiment, experiment.runs.front(), "has none of strength, bearing_rad, received",
               "at least one of them");
    for (const Run& run : experiment.runs) {
        if (run.has("bearing_rad") && !run.has("true_bearing_rad"))
            refuse(experiment, run, "has bearing_rad but no true_bearing_rad",
                   "the truth beside the measurement");
        constexpr double kClear = 0.8, kNone = 0.5;
        const auto &bearing = run.column("bearing_rad"), &truth = run.column("true_bearing_rad");
        if (follows(bearing, truth, -1) > kClear && follows(bearing, truth, 1) < kNone)
            refuse(experiment, run,
                   "bearing_rad is the mirror image of true_bearing_rad: one of them runs clockwise",
                   "counter-clockwise bearings in the receiver's frame");
    }
    const auto& runs = experiment.runs;
    if (contrary(runs, [](const Run& run) {
            // Far off strengths stay at a floor: only runs from near to far show which way they go.
            const auto& distance = run.column("distance_m");
            const double near = stats::quantile(distance, 0.1), far = stats::quantile(distance, 0.9);
            return !(far > 2 * near) ? 0.0
                                     : rank_correlation(run.column("distance_m"), run.column("strength"));
        }))
        refuse(experiment, runs.front(), "strength grows with distance_m: swapped columns",
               "strengths that fall with distance");
    const auto none = [](const Run& run) {
        const auto& received = run.column("received");
        return std::none_of(received.begin(), received.end(), [](double one) { return one > 0; });
    };
    if (experiment.has("received") && std::all_of(runs.begin(), runs.end(), none))
        refuse(experiment, runs.front(), "received is 0 in every row of every run: nothing shows why",
               "some messages that arrive; is the receiver on, and in reach?");
}

}  // namespace

std::vector<double> pooled(const Experiment& experiment, std::string_view column) {
    std::vector<double> all;
    for (const Run& run : experiment.runs) {
        const auto& values = run.column(column);
        all.insert(all.end(), values.begin(), values.end());
        if (values.empty()) all.insert(all.end(), run.rows, std::nan(""));
    }
    return all;
}

void check_kind(Experiment& experiment) {
    constexpr std::array kChecks{check_proximity, check_motion,        check_rab,   check_microphone,
                                 check_ground,    check_accelerometer, check_timing};  // in the order of Kind
    if (experiment.kind == Kind::Described) return;  // its ranges say what can be said
    kChecks.at(experiment.kind)(experiment);
}

}  // namespace puckloop::gap
