#include "gap/begin/expected_time.h"

#include "gap/stats/robust.h"
#include "gap/validate/checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace puckloop::gap {

namespace {

/// Processor time of a thousand rows, s, and the power of the rows by which it grows.
struct Growth {
    double thousand, power;

    double of(std::size_t rows) const { return thousand * std::pow(static_cast<double>(rows) / 1000, power); }
};
/// Where nothing is wrong and where something is: of made experiments of 2,400 and 20,000 rows, and of
/// published ones.
struct Cost {
    Growth nothing, something;
};
Cost cost_of(const Kind& kind) {
    switch (kind) {
    case Kind::Proximity:
        return {{0.45, 1.56}, {3.5, 0.95}};
    case Kind::Motion:
        return {{5.5, 0.8}, {6.4, 0.8}};
    case Kind::Rab:
        return {{0.63, 0.82}, {1.25, 0.82}};
    case Kind::Microphone:
        return {{0.33, 0.8}, {0.8, 0.8}};
    case Kind::Ground:
        return {{0.33, 0.9}, {4.0, 0.45}};
    case Kind::Accelerometer:
        return {{0.7, 0.78}, {2.9, 0.58}};
    case Kind::Timing:
        return {{1.27, 0.8}, {2.0, 0.8}};
    case Kind::Described:
        break;
    }
    return {{0.5, 0.8}, {0.8, 0.8}};
}

constexpr double kParallel = 0.7;  // share of the work that threads divide among them
constexpr double kPushed = 6.0;    // a sum that may be pushed keeps five histories a row
constexpr std::size_t kJumps = 5;  // so many look like pushes

/// Rows in which a drive goes by far more or less than its wheels ask for.
std::size_t jumps_of(const Experiment& experiment) {
    constexpr double kFar = 8.0;  // robust deviations
    std::vector<double> off;
    for (const Run& run : experiment.runs) {
        const auto &x = run.column("x_m"), &y = run.column("y_m");
        for (std::size_t i = 1; i < run.rows; ++i) {
            const auto [left, right] = steps_made(run, i);
            const double way = std::hypot(x[i] - x[i - 1], y[i] - y[i - 1]) -
                               std::abs(left + right) / 2 * metres_per_step(experiment);
            if (std::isfinite(way)) off.push_back(way);
        }
    }
    const double middle = stats::median(off), far = kFar * stats::robust_scale(off);
    return static_cast<std::size_t>(
        std::count_if(off.begin(), off.end(), [&](double way) { return std::abs(way - middle) > far; }));
}

}  // namespace

ExpectedTime expected_time(const Experiment& experiment, unsigned threads) {
    const bool pushed = experiment.kind == Kind::Motion && jumps_of(experiment) >= kJumps;
    const Cost cost = cost_of(experiment.kind);
    const double by = (pushed ? kPushed : 1.0) * (1 - kParallel + kParallel / std::max(1U, threads));
    return {cost.nothing.of(experiment.rows()) * by, cost.something.of(experiment.rows()) * by};
}

double seconds_left(double expected, double elapsed, double share) {
    const double left = 1 - std::clamp(share, 0.0, 1.0);
    return left * (left * expected + elapsed);
}

std::string rough_time(double seconds) {
    constexpr double kMinute = 60;
    if (seconds < 1) return "about a second";
    if (seconds < 2 * kMinute) return fmt::format("about {:.0f} s", seconds);
    return fmt::format("about {:.0f} min", seconds / kMinute);
}

}  // namespace puckloop::gap
