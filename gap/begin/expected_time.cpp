#include "gap/begin/expected_time.h"

#include "gap/stats/robust.h"
#include "gap/validate/checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace puckloop::gap {

namespace {

/// CPU seconds of a thousand rows, in the order of Kind; the middle, in the logarithm, of what made
/// experiments of 360 to 20,000 rows and published ones take.
constexpr double kSecondsPerThousand[] = {1.5, 5.0, 1.0, 0.6, 0.8, 0.7, 1.0};
constexpr double kGrowth = 0.8;    // large experiments are begun on a part of their rows
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

double expected_seconds(const Experiment& experiment, unsigned threads) {
    const bool pushed = experiment.kind == Kind::Motion && jumps_of(experiment) >= kJumps;
    const double cpu = kSecondsPerThousand[static_cast<std::size_t>(experiment.kind)] *
                       (pushed ? kPushed : 1.0) *
                       std::pow(static_cast<double>(experiment.rows()) / 1000, kGrowth);
    return cpu * (1 - kParallel + kParallel / std::max(1U, threads));
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
