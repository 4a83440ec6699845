// Do tracker and counters tell the same time? Two loggers that were started by hand, or whose clocks differ
// by a few parts in a thousand, make an error of heading that is turn rate times lateness: it looks like
// slip.

#include "gap/sync/counted_path.h"
#include "gap/sync/sync.h"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kWindow = 0.6;         // s: changes are compared over at least this long
constexpr double kPrior = 0.3;          // s: lateness and its drift are not believed to be much larger
constexpr int kRounds = 6;              // of correcting clocks and fitting the robot in turn
constexpr double kEvidence = 20.0;      // BIC by which drifting clocks must do better than steady ones
constexpr double kLeastDrift = 0.02;    // s: less hides in the spacing of rows
constexpr double kLeastDrifting = 0.3;  // share of runs whose clock must drift by itself
constexpr double kDeviations = 4.0;
constexpr double kAgreed = 3.0;  // times what runs differ by: a mean lateness that is theirs in common

/// How the clock of a run's counters stands to its tracker's.
struct ClockError {
    double late = 0.0;   ///< s by which the tracker's rows come after the counters', in the middle of the run
    double drift = 0.0;  ///< s by which `late` grows from the run's first row to its last
    double late_sd = 0.0, drift_sd = 0.0;
};

/// One window: what the tracker saw (way, heading), what the counters say, and how that changes with lateness
/// and its drift.
struct Window {
    std::array<double, 2> seen{};
    std::array<double, 2> counted{};  ///< half the sum and the difference of the wheels, steps
    std::array<double, 2> late{}, drift{};
    double span = 0.0;
};

std::vector<Window> windows_of(const CountedPath& path, const ClockError& clock) {
    std::vector<Window> all;
    const double step = path.span() / static_cast<double>(path.time.size() - 1);
    const std::size_t rows = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(kWindow / step)));
    for (std::size_t i = 0; i + rows < path.time.size(); i += rows) {
        Window one;
        double sign = -1.0;
        for (const std::size_t row : {i, i + rows}) {
            const double place = (path.time[row] - path.middle()) / path.span();
            const double time = path.when[row] - clock.late - clock.drift * place;
            const auto left = path.left_at(time), right = path.right_at(time);
            one.seen[0] += sign * path.way[row];
            one.seen[1] += sign * path.heading[row];
            one.span += sign * path.time[row];
            const std::array<double, 2> value{(left.steps + right.steps) / 2, right.steps - left.steps},
                rate{(left.rate + right.rate) / 2, right.rate - left.rate};
            for (std::size_t k = 0; k < 2; ++k) {
                one.counted[k] += sign * value[k];
                one.late[k] -= sign * rate[k];
                one.drift[k] -= sign * rate[k] * place;
            }
            sign = 1.0;
        }
        all.push_back(one);
    }
    return all;
}

Eigen::Vector3d terms(const Window& one, std::size_t k) {
    return k == 0 ? Eigen::Vector3d(one.counted[0], one.seen[1], 0.0)
                  : Eigen::Vector3d(one.counted[1], one.counted[0], one.span);
}

/// The robot's own numbers: way and heading as sums of what was counted, turned and waited.
struct Robot {
    std::array<Eigen::Vector3d, 2> share{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    std::array<double, 2> sd{1.0, 1.0};

    double error(const Window& one, std::size_t k) const { return one.seen[k] - share[k].dot(terms(one, k)); }
};

double weight_of(double error, double sd) {
    constexpr double kHuber = 2.0;
    return std::min(1.0, kHuber * sd / std::max(std::abs(error), 1e-12));
}

Robot robot_of(const std::vector<std::vector<Window>>& runs, const Robot& before) {
    Robot robot;
    for (std::size_t k = 0; k < 2; ++k) {
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        Eigen::Vector3d right = Eigen::Vector3d::Zero();
        for (const auto& run : runs)
            for (const Window& one : run) {
                const Eigen::Vector3d x = terms(one, k);
                const double weight = weight_of(before.error(one, k), before.sd[k]);
                normal += weight * x * x.transpose();
                right += weight * x * one.seen[k];
            }
        robot.share[k] = normal.completeOrthogonalDecomposition().solve(right);
        std::vector<double> errors;
        for (const auto& run : runs)
            for (const Window& one : run)
                errors.push_back(robot.error(one, k));
        robot.sd[k] = robust_sd(std::move(errors));
    }
    return robot;
}

/// One Gauss-Newton step on a run's clock; `steady`: its drift stays as it is.
void correct(const std::vector<Window>& run, const Robot& robot, bool steady, ClockError& clock) {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Identity() / (kPrior * kPrior);
    Eigen::Vector2d right(-clock.late / (kPrior * kPrior), -clock.drift / (kPrior * kPrior));
    for (const Window& one : run)
        for (std::size_t k = 0; k < 2; ++k) {
            const double error = robot.error(one, k);
            const Eigen::Vector2d slope(robot.share[k][0] * one.late[k], robot.share[k][0] * one.drift[k]);
            const double weight = weight_of(error, robot.sd[k]) / (robot.sd[k] * robot.sd[k]);
            normal += weight * slope * slope.transpose();
            right += weight * slope * error;
        }
    if (steady) {
        clock.late += right[0] / normal(0, 0);
        return;
    }
    const Eigen::Matrix2d covariance = normal.inverse();
    const Eigen::Vector2d step = covariance * right;
    clock.late += step[0];
    clock.drift += step[1];
    clock.late_sd = std::sqrt(covariance(0, 0));
    clock.drift_sd = std::sqrt(covariance(1, 1));
}

struct Clocks {
    std::vector<ClockError> errors;
    double deviance = 0.0;  ///< -2 ln likelihood of the changes, up to a constant
    double changes = 0.0;
};

Clocks fit_clocks(const std::vector<CountedPath>& paths, bool steady) {
    Clocks clocks;
    clocks.errors.resize(paths.size());
    Robot robot;
    std::vector<std::vector<Window>> runs(paths.size());
    const auto look = [&] {
        for (std::size_t r = 0; r < paths.size(); ++r)
            runs[r] = windows_of(paths[r], clocks.errors[r]);
    };
    look();
    robot.sd = {1e9, 1e9};
    for (int round = 0; round < kRounds; ++round) {
        robot = robot_of(runs, robot);
        for (std::size_t r = 0; r < paths.size(); ++r)
            correct(runs[r], robot, steady, clocks.errors[r]);
        look();
    }
    robot = robot_of(runs, robot);
    for (std::size_t k = 0; k < 2; ++k) {
        double squares = 0.0, count = 0.0;
        for (const auto& run : runs)
            for (const Window& one : run) {
                const double error = robot.error(one, k);
                squares += error * error * weight_of(error, robot.sd[k]);
                ++count;
            }
        clocks.deviance += count * std::log(std::max(squares / std::max(count, 1.0), 1e-18));
        clocks.changes += count;
    }
    return clocks;
}

}  // namespace

void align_clocks(Experiment& experiment) {
    if (experiment.kind != Kind::Motion) return;
    const auto paths = counted_paths(experiment);
    if (paths.empty()) return;
    const Clocks steady = fit_clocks(paths, true), drifting = fit_clocks(paths, false);
    const auto runs = static_cast<double>(paths.size());
    const double better = steady.deviance - drifting.deviance - runs * std::log(drifting.changes);
    double clear = 0.0, weights = 0.0, common = 0.0;
    for (const ClockError& clock : drifting.errors) {
        if (std::abs(clock.drift) > std::max(kDeviations * clock.drift_sd, kLeastDrift)) ++clear;
        const double weight = 1 / (clock.late_sd * clock.late_sd);
        weights += weight;
        common += weight * clock.late;
    }
    if (better < kEvidence || clear < kLeastDrifting * runs) return;
    common /= weights;
    // Runs lined up by hand, each its own way, have a mean lateness too, but nothing that makes it: only one
    // that they agree about is a tracker's.
    double squares = 0.0;
    for (const ClockError& clock : drifting.errors)
        squares += (clock.late - common) * (clock.late - common) / runs;
    if (std::abs(common) < kAgreed * std::sqrt(squares)) common = 0.0;
    stats::Range late, rates;
    for (std::size_t r = 0; r < paths.size(); ++r) {
        const ClockError& clock = drifting.errors[r];
        Run& run = experiment.runs[r];
        const auto& time = run.column("t_s");
        if (run.counted_at.empty()) run.counted_at = time;
        for (std::size_t i = 0; i < time.size(); ++i)
            run.counted_at[i] -=
                clock.late - common + clock.drift * (time[i] - paths[r].middle()) / paths[r].span();
        const double half = std::abs(clock.drift) / 2, rate = clock.drift / paths[r].span();
        late.take({clock.late - half, clock.late + half});
        rates.take({rate});
    }
    experiment.caution(
        "the clocks of tracker and counters run apart: the tracker's rows are {:.0f} to {:.0f} ms late, and "
        "the lateness changes by {:.2f} to {:.2f} % of the time inside a run ({:.0f} of {} runs beyond "
        "doubt). Counters were read at corrected times before anything was fitted",
        1e3 * late.low, 1e3 * late.high, 100 * rates.low, 100 * rates.high, clear, paths.size());
}

}  // namespace puckloop::gap
