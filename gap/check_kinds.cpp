#include "gap/check_kinds.h"

#include "base/error.h"
#include "gap/columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::gap {

namespace {

[[noreturn]] void refuse(const Experiment& experiment, const Run& run, const std::string& problem,
                         const std::string& expected) {
    throw InputError((experiment.folder / run.file).string(), "", problem, expected);
}

/// Rank correlation of two columns over rows where both are there; 0 when there are few.
double rank_correlation(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<std::pair<double, double>> pairs;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        if (!std::isnan(a[i]) && !std::isnan(b[i])) pairs.emplace_back(a[i], b[i]);
    if (pairs.size() < 8) return 0.0;
    const auto ranks = [&](auto key) {
        std::vector<std::size_t> order(pairs.size());
        for (std::size_t i = 0; i < order.size(); ++i)
            order[i] = i;
        std::sort(order.begin(), order.end(),
                  [&](std::size_t i, std::size_t j) { return key(pairs[i]) < key(pairs[j]); });
        std::vector<double> rank(pairs.size());
        for (std::size_t i = 0; i < order.size();) {
            std::size_t j = i;
            while (j < order.size() && key(pairs[order[j]]) == key(pairs[order[i]]))
                ++j;
            for (std::size_t k = i; k < j; ++k)
                rank[order[k]] = static_cast<double>(i + j - 1) / 2;
            i = j;
        }
        return rank;
    };
    const auto ra = ranks([](const auto& p) { return p.first; });
    const auto rb = ranks([](const auto& p) { return p.second; });
    const double mean = static_cast<double>(pairs.size() - 1) / 2;
    double ab = 0, aa = 0, bb = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        ab += (ra[i] - mean) * (rb[i] - mean);
        aa += (ra[i] - mean) * (ra[i] - mean);
        bb += (rb[i] - mean) * (rb[i] - mean);
    }
    return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0.0;
}

/// A reflective sensor sees more when the wall is nearer; the other way round the columns are exchanged or
/// the reading has the wrong sign.
void check_proximity(Experiment& experiment) {
    std::vector<double> distances, readings;
    for (const Run& run : experiment.runs) {
        distances.insert(distances.end(), run.column("distance_m").begin(), run.column("distance_m").end());
        readings.insert(readings.end(), run.column("reading").begin(), run.column("reading").end());
    }
    const double correlation = rank_correlation(distances, readings);
    if (correlation > 0.5)
        refuse(experiment, experiment.runs.front(),
               fmt::format("reading grows with distance_m (rank correlation {:.2f}): columns swapped, or "
                           "ambient counts instead of "
                           "ambient minus lit",
                           correlation),
               "readings that fall with distance");
    const double furthest = *std::max_element(distances.begin(), distances.end(), [](double a, double b) {
        return std::isnan(a) || (!std::isnan(b) && a < b);
    });
    if (furthest > 1.0)
        refuse(
            experiment, experiment.runs.front(),
            fmt::format("distance_m reaches {:.3g} m, where these sensors see nothing: wrong unit", furthest),
            "distances below 1 m; say unit = \"cm\" or \"mm\" in [columns]");
}

struct Path {
    double length = 0.0, turned = 0.0;  // tracked
    double left = 0.0, right = 0.0;     // steps of either wheel, absolute
    double largest_jump = 0.0, duration = 0.0;
    double largest_turn = 0.0;
    double forward = 0.0;  // signed displacement along the heading
};

Path measure(const Run& run) {
    const auto &x = run.column("x_m"), &y = run.column("y_m"), &theta = run.column("theta_rad");
    const auto &left = run.column("steps_left"), &right = run.column("steps_right"),
               &time = run.column("t_s");
    Path path;
    std::size_t last = run.rows;
    for (std::size_t i = 0; i < run.rows; ++i) {
        if (std::isnan(x[i]) || std::isnan(y[i]) || std::isnan(theta[i])) continue;
        if (last < run.rows) {
            const double step = std::hypot(x[i] - x[last], y[i] - y[last]);
            const double turn = std::remainder(theta[i] - theta[last], 2 * std::numbers::pi);
            path.length += step;
            path.turned += turn;
            path.largest_jump = std::max(path.largest_jump, step / std::max(time[i] - time[last], 1e-3));
            path.largest_turn = std::max(path.largest_turn, std::abs(turn));
            path.forward += (x[i] - x[last]) * std::cos(theta[i]) + (y[i] - y[last]) * std::sin(theta[i]);
            if (!left.empty() && !right.empty() &&
                !std::isnan(left[i] + right[i] + left[last] + right[last])) {
                path.left += std::abs(left[i] - left[last]);
                path.right += std::abs(right[i] - right[last]);
            }
            path.duration += time[i] - time[last];
        }
        last = i;
    }
    return path;
}

double nominal(const Experiment& experiment, const std::string& name, double fallback) {
    const auto place = experiment.nominal.find(name);
    return place == experiment.nominal.end() ? fallback : place->second;
}

/// Left and right wheel exchanged turn the other way; millimetres taken for metres go a thousand times too
/// far.
void check_motion(Experiment& experiment) {
    double agree = 0.0, turned = 0.0;
    double driven = 0.0, tracked = 0.0, duration = 0.0;
    bool steps = false;
    const double metre_per_step = 2 * std::numbers::pi *
                                  nominal(experiment, "robot.wheel_radius_left", 0.0205) /
                                  nominal(experiment, "robot.steps_per_turn", 1000);
    for (const Run& run : experiment.runs) {
        const Path path = measure(run);
        tracked += path.length;
        duration += path.duration;
        if (run.has("steps_left") != run.has("steps_right") || run.has("cmd_left") != run.has("cmd_right"))
            refuse(experiment, run, "has one wheel's column without the other's", "both");
        if (!run.has("steps_left") && !run.has("cmd_left"))
            refuse(experiment, run, "has neither steps_left, steps_right nor cmd_left, cmd_right",
                   "what the wheels did or were told");
        if (path.largest_turn > 2.5)
            experiment.cautions.push_back(
                fmt::format("{}: theta_rad jumps by {:.2f} rad between two rows: too sparse, or a wrong unit",
                            run.file, path.largest_turn));
        const auto &left = run.column(run.has("steps_left") ? "steps_left" : "cmd_left"),
                   &right = run.column(run.has("steps_left") ? "steps_right" : "cmd_right");
        const auto &theta = run.column("theta_rad"), &time = run.column("t_s");
        steps = steps || run.has("steps_left");
        driven += (path.left + path.right) / 2 * metre_per_step;
        for (std::size_t i = 1; i < run.rows; ++i) {
            const double turn = std::remainder(theta[i] - theta[i - 1], 2 * std::numbers::pi);
            const double asked = run.has("steps_left")
                                     ? (right[i] - right[i - 1]) - (left[i] - left[i - 1])
                                     : (right[i - 1] - left[i - 1]) * (time[i] - time[i - 1]);
            if (std::isnan(turn) || std::isnan(asked)) continue;
            agree += turn * asked;
            turned += std::abs(turn * asked);
        }
    }
    const Run& first = experiment.runs.front();
    if (turned > 0 && agree < -0.5 * turned)
        refuse(experiment, first,
               "the robot turns the other way than its wheels: left and right are swapped, or theta_rad runs "
               "clockwise",
               "the right wheel faster for a counter-clockwise turn");
    if (steps && driven > 0.1 && (tracked > 5 * driven || tracked < driven / 5) && tracked > 1e-9) {
        if (tracked > 5 * driven || turned == 0 || tracked > 0.01 * driven)
            refuse(experiment, first,
                   fmt::format("the tracker saw {:.3g} m while the wheels turned {:.3g} m: wrong unit of "
                               "x_m, y_m or a wrong "
                               "robot.wheel_radius / steps_per_turn in [nominal]",
                               tracked, driven),
                   "the same within a factor of five");
    }
    if (duration > 0 && tracked / duration > 3.0)
        refuse(experiment, first,
               fmt::format("the robot moves {:.3g} m/s on average: wrong unit of x_m, y_m or t_s",
                           tracked / duration),
               "at most 3 m/s");
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
    const double zero = nominal(experiment, "accelerometer.zero", 2048),
                 gain = nominal(experiment, "accelerometer.gain", 800);
    for (const Run& run : experiment.runs) {
        double sum = 0.0, count = 0.0;
        for (const double value : run.column("az"))
            if (!std::isnan(value)) {
                sum += (value - zero) / gain;
                ++count;
            }
        if (count > 0 && (sum / count < 0.2 || sum / count > 3.0))
            refuse(experiment, run,
                   fmt::format("az is {:.2f} g on average: axes swapped, or accelerometer.zero and gain of "
                               "another sensor",
                               sum / count),
                   "about 1 g; say accelerometer.zero and accelerometer.gain in [nominal]");
    }
}

void check_rab(Experiment& experiment) {
    if (!experiment.has("strength") && !experiment.has("bearing_rad") && !experiment.has("received"))
        refuse(experiment, experiment.runs.front(), "has none of strength, bearing_rad, received",
               "at least one of them");
    for (const Run& run : experiment.runs) {
        if (run.has("bearing_rad") && !run.has("true_bearing_rad"))
            refuse(experiment, run, "has bearing_rad but no true_bearing_rad",
                   "the truth beside the measurement");
        if (rank_correlation(run.column("distance_m"), run.column("strength")) > 0.6)
            refuse(experiment, run, "strength grows with distance_m: swapped columns",
                   "strengths that fall with distance");
    }
}

}  // namespace

void check_kind(Experiment& experiment) {
    switch (experiment.kind) {
    case Kind::Proximity:
        return check_proximity(experiment);
    case Kind::Motion:
        return check_motion(experiment);
    case Kind::Rab:
        return check_rab(experiment);
    case Kind::Microphone:
        return check_microphone(experiment);
    case Kind::Ground:
        return check_ground(experiment);
    case Kind::Accelerometer:
        return check_accelerometer(experiment);
    case Kind::Timing:
        return;
    }
}

}  // namespace puckloop::gap
