#include "gap/identify/robot_clock.h"

#include "gap/clean/quantum.h"
#include "gap/stats/robust.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace puckloop::gap {

namespace {

constexpr double kLeastFollowed = 0.5;  // of what the clock scatters by: less, and most of it is its own
constexpr double kFollowErrors = 2.0;   // standard errors
constexpr double kMostRounding = 0.5;   // of the clock's scatter that its rounding may make
constexpr std::size_t kLeastFrames = 30;

/// What is uneven in a run's clocks from a frame to the next, s.
struct Uneven {
    std::vector<double> robot, host;
};

void add_uneven(const Run& run, Uneven& all) {
    const auto &robot = run.column("t_robot_s"), &host = run.column("t_host_s"), &seq = run.column("seq");
    std::vector<double> robots, hosts;
    for (std::size_t i = 1; i < run.rows && !robot.empty(); ++i) {
        if (!seq.empty() && seq[i] - seq[i - 1] != 1.0) continue;
        const double one = robot[i] - robot[i - 1], other = host[i] - host[i - 1];
        if (!std::isfinite(one + other)) continue;
        robots.push_back(one);
        hosts.push_back(other);
    }
    if (robots.empty()) return;
    const double usual = stats::median(robots), arrives = stats::median(hosts);
    for (double& one : robots)
        one -= usual;
    for (double& one : hosts)
        one -= arrives;
    robots = stats::winsorised(robots);
    hosts = stats::winsorised(hosts);
    all.robot.insert(all.robot.end(), robots.begin(), robots.end());
    all.host.insert(all.host.end(), hosts.begin(), hosts.end());
}

}  // namespace

bool Following::errs() const {
    return slope + kFollowErrors * sd < kLeastFollowed;
}

Following following(const Experiment& experiment) {
    Uneven uneven;
    std::vector<double> times;
    for (const Run& run : experiment.runs) {
        add_uneven(run, uneven);
        const auto& robot = run.column("t_robot_s");
        times.insert(times.end(), robot.begin(), robot.end());
    }
    Following result;
    result.sd = INFINITY;
    const auto n = static_cast<double>(uneven.robot.size());
    if (uneven.robot.size() < kLeastFrames) return result;
    double square = 0.0, product = 0.0, host = 0.0;
    for (std::size_t i = 0; i < uneven.robot.size(); ++i) {
        square += uneven.robot[i] * uneven.robot[i];
        product += uneven.robot[i] * uneven.host[i];
        host += uneven.host[i] * uneven.host[i];
    }
    result.scatter = std::sqrt(square / n);
    const double step = quantum_of(times), rounding = n * step * step / 6;  // of a difference
    if (!(square > 0) || rounding > kMostRounding * square) return result;
    result.slope = product / (square - rounding);
    result.sd = std::sqrt(std::max(host - result.slope * product, 0.0) / square / n);
    return result;
}

NotIdentified not_by_clock(const Study& study, const Fit& fit) {
    NotIdentified result;
    for (const std::size_t effect : fit.effects)
        if (study.candidates()[effect].effect->rests_on_clock) result.effects.push_back(effect);
    if (result.effects.empty()) return {};
    const Following clock = following(study.experiment());
    if (!clock.errs()) return {};
    result.why =
        fmt::format("arrivals do not follow what t_robot_s scatters by from frame to frame ({:.2g} ms; "
                    "they follow {:.0f} +- {:.0f} % of it), so that this clock errs and does not show "
                    "when a frame was made: not identifiable by these data",
                    clock.scatter * 1e3, 100 * clock.slope, 100 * clock.sd);
    return result;
}

}  // namespace puckloop::gap
