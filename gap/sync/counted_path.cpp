#include "gap/sync/counted_path.h"

#include "gap/stats/robust.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace puckloop::gap {

namespace {

constexpr std::size_t kLeastRows = 60;

bool whole(const Run& run, std::size_t row) {
    return !std::isnan(run.column("x_m")[row] + run.column("y_m")[row] + run.column("theta_rad")[row] +
                       run.column("t_s")[row]);
}

CountedPath path_of(const Run& run) {
    const auto &x = run.column("x_m"), &y = run.column("y_m"), &theta = run.column("theta_rad"),
               &time = run.column("t_s"), &left = run.column("steps_left"),
               &right = run.column("steps_right");
    CountedPath path;
    std::size_t last = run.rows;
    for (std::size_t i = 0; i < run.rows; ++i) {
        if (!std::isnan(left[i] + right[i] + time[i])) {
            path.counted_time.push_back(time[i]);
            path.left.push_back(left[i]);
            path.right.push_back(right[i]);
        }
        if (!whole(run, i)) continue;
        double way = 0.0, heading = 0.0;
        if (last < run.rows) {
            const double turn = std::remainder(theta[i] - theta[last], 2 * std::numbers::pi);
            const double middle = theta[last] + turn / 2;
            way = path.way.back() + (x[i] - x[last]) * std::cos(middle) + (y[i] - y[last]) * std::sin(middle);
            heading = path.heading.back() + turn;
        }
        path.time.push_back(time[i]);
        path.when.push_back(run.counted_at.empty() ? time[i] : run.counted_at[i]);
        path.way.push_back(way);
        path.heading.push_back(heading);
        last = i;
    }
    if (path.time.size() < kLeastRows || path.counted_time.size() < kLeastRows) return {};
    return path;
}

}  // namespace

CountedPath::Counter CountedPath::at(const std::vector<double>& steps, double when) const {
    if (when < counted_time.front()) return {steps.front(), 0.0};
    if (when > counted_time.back()) return {steps.back(), 0.0};
    auto after = std::upper_bound(counted_time.begin(), counted_time.end(), when);
    after = std::clamp(after, counted_time.begin() + 1, counted_time.end() - 1);
    const auto i = static_cast<std::size_t>(after - counted_time.begin());
    const double rate = (steps[i] - steps[i - 1]) / std::max(counted_time[i] - counted_time[i - 1], 1e-9);
    return {steps[i - 1] + rate * (when - counted_time[i - 1]), rate};
}

std::vector<CountedPath> counted_paths(const Experiment& experiment) {
    std::vector<CountedPath> paths;
    for (const Run& run : experiment.runs) {
        if (!run.has("steps_left") || !run.has("steps_right")) return {};
        paths.push_back(path_of(run));
        if (paths.back().time.empty()) return {};
    }
    return paths;
}

double robust_sd(std::vector<double> errors) {
    for (double& error : errors)
        error = std::abs(error);
    return errors.empty() ? 1.0 : std::max(stats::kMadToSigma * stats::upper_median(std::move(errors)), 1e-9);
}

}  // namespace puckloop::gap
