#include "gap/identify/drive_filter.h"

#include "gap/stats/robust.h"

#include <Eigen/Dense>
#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace puckloop::gap {

namespace {

constexpr double kRowTail = 6.0;       // degrees of freedom by which rows far out pull
constexpr double kSpeedJump = 6.0;     // robust deviations of a counted speed's change that begin it again
constexpr double kUnknownSpeed = 1e4;  // of the fastest speed's square: nothing is known of a speed
constexpr double kPriorWidth = 4.0;    // of ln of a noise about its first guess
constexpr double kSlopeStep = 1e-4, kCurvatureStep = 1e-2;
constexpr double kLeastNoise = 1e-12, kLeastCounter = 1e-7;  // of a noise; m of a counter's
constexpr double kLeastSpan = 1e-6;                          // s
constexpr double kCostConverged = 1e-8;                      // of the cost
constexpr int kMostDescents = 60;
constexpr double kCounterBegins[] = {0.0, 2.0};  // ln of the counters' noise beside the first guess

enum NoiseNumber : std::size_t {
    kCounter,
    kSlipWay,
    kSlipTurn,
    kSpeedWay,
    kSpeedTurn,
    kSeenWay,
    kSeenTurn,
    kNoises,
    kFreeShare = kNoises
};
using NoiseNumbers = std::array<double, kNoises + 1>;  // ln of the noises' sd, the share

double scale_of(std::vector<double> sizes) {
    if (sizes.empty()) return kLeastNoise;
    for (double& one : sizes)
        one = std::abs(one);
    return std::max({stats::kMadToSigma * stats::upper_median(sizes), 0.1 * stats::mean(sizes), kLeastNoise});
}

/// Of a channel's values from row to row, inside runs.
template <class Change>
std::vector<double> row_changes(const CountedDrive& drive, std::size_t back, const Change& change) {
    std::vector<double> all;
    for (std::size_t i = back; i < drive.starts.size(); ++i) {
        bool inside = true;
        for (std::size_t k = 0; k < back; ++k)
            inside = inside && drive.starts[i - k] == 0;
        if (inside) all.push_back(change(i));
    }
    return all;
}

struct ChannelNoise {
    double counter, coarse, slip, speed, seen;  // variances: a row, a reading, a row, a second, a reading
};

/// A channel's part of a fit: what does not depend on the numbers is worked out once.
class ChannelFilter {
  public:
    ChannelFilter(const CountedDrive& drive, const DriveChannel& own) : drive_(drive), own_(own) {
        const auto speed = [&](std::size_t i) {
            return own.counted[i] / std::max(drive.spans[i], kLeastSpan);
        };
        const auto changed = row_changes(drive, 2, [&](std::size_t i) { return speed(i) - speed(i - 1); });
        speed_change_ = scale_of(changed);
        jumps_.assign(own.seen.size(), 0);
        for (std::size_t i = 2; i < jumps_.size(); ++i)
            jumps_[i] = drive.starts[i] == 0 && drive.starts[i - 1] == 0 &&
                        std::abs(speed(i) - speed(i - 1)) > kSpeedJump * speed_change_;
        fastest_ = kLeastNoise;
        for (std::size_t i = 0; i < jumps_.size(); ++i)
            fastest_ = std::max(fastest_, std::abs(drive.starts[i] != 0 ? 0.0 : speed(i)));
    }
    double speed_change() const { return speed_change_; }

    double cost(const ChannelNoise& noise, double share) const {
        using State = Eigen::Vector3d;
        State x = State::Zero();  // pose, counted, speed
        Eigen::Matrix3d p = Eigen::Matrix3d::Zero();
        double cost = 0.0, counted = 0.0;
        const auto learn = [&](int k, double value, double variance, bool costs) {
            const double total = p(k, k) + variance, off = value - x[k], squared = off * off / total;
            const double trust = squared > 1 ? (kRowTail + 1) / (kRowTail + squared) : 1.0;
            if (costs) cost += (kRowTail + 1) / 2 * std::log1p(squared / kRowTail) + std::log(total) / 2;
            const State gain = p.col(k) * (trust / total);
            x += gain * off;
            p -= gain * p.row(k).eval();
            p = (p + p.transpose().eval()) / 2;
        };
        int rows = 0;
        for (std::size_t i = 0; i < own_.seen.size(); ++i) {
            if (drive_.starts[i] != 0) {
                x << own_.seen[i], 0.0, 0.0;
                p.setZero();
                p(0, 0) = noise.seen;
                p(1, 1) = noise.coarse;
                p(2, 2) = kUnknownSpeed * fastest_ * fastest_;
                counted = 0.0;
                rows = 0;
                continue;
            }
            const double span = std::max(drive_.spans[i], kLeastSpan);
            const double without = own_.without[i], gain_without = own_.gain_without[i];
            const double gain = gain_without + share * (own_.gain_with[i] - gain_without);
            const double known = without + share * (own_.with[i] - without) - gain * own_.counted[i];
            p(2, 2) += noise.speed * span + (jumps_[i] != 0 ? kUnknownSpeed * fastest_ * fastest_ : 0.0);
            x[0] += known + gain * span * x[2];
            x[1] += span * x[2];
            // P <- F P F', F = [1 0 g; 0 1 t; 0 0 1]
            p.row(0) += gain * span * p.row(2);
            p.row(1) += span * p.row(2);
            p.col(0) += gain * span * p.col(2);
            p.col(1) += span * p.col(2);
            p(0, 0) += noise.slip;
            p(1, 1) += noise.counter;
            counted += own_.counted[i];
            ++rows;
            const bool fresh = rows < 2 || jumps_[i] != 0;
            learn(1, counted, noise.coarse, !fresh);
            learn(0, own_.seen[i], noise.seen, true);
        }
        return cost;
    }

  private:
    const CountedDrive& drive_;
    const DriveChannel& own_;
    std::vector<char> jumps_;
    double speed_change_ = 0.0, fastest_ = 0.0;
};

/// Which channels a number acts in.
struct Touches {
    bool way, turn;
};
Touches channels_of(std::size_t number) {
    const bool both = number == kCounter || number == kFreeShare;
    const bool way = number == kSlipWay || number == kSpeedWay || number == kSeenWay;
    return {both || way, both || !way};
}

class DriveLikelihood {
  public:
    DriveLikelihood(const CountedDrive& drive, const DriveNoise& noise)
        : noise_(noise),
          coarse_(drive.quantum * drive.quantum / 12 + kLeastNoise * kLeastNoise),
          way_(drive, drive.way),
          turn_(drive, drive.turn),
          errors_{drive.way.errors, drive.turn.errors} {
        const double span = std::max(stats::upper_median(drive.spans), kLeastSpan);
        const auto first = [&](const DriveChannel& own, double change, NoiseNumber seen, NoiseNumber slip,
                               NoiseNumber speed) {
            const double sd = scale_of(row_changes(
                drive, 1, [&](std::size_t i) { return own.seen[i] - own.seen[i - 1] - own.without[i]; }));
            guess_[seen] = std::log(sd / 2);
            guess_[slip] = std::log(sd / 10);
            guess_[speed] = std::log(change / std::sqrt(span) / 3);
        };
        first(drive.way, way_.speed_change(), kSeenWay, kSlipWay, kSpeedWay);
        first(drive.turn, turn_.speed_change(), kSeenTurn, kSlipTurn, kSpeedTurn);
        guess_[kCounter] = std::log(std::max(turn_.speed_change() * span / 4, kLeastCounter));
    }

    const NoiseNumbers& guess() const { return guess_; }

    double cost(const NoiseNumbers& now, const Touches& of) const {
        const auto variance = [&](NoiseNumber one) { return std::exp(2 * now[one]); };
        const double counter = noise_.counters ? variance(kCounter) : 0.0;
        const auto channel = [&](const ChannelFilter& own, double errors, NoiseNumber slip, NoiseNumber speed,
                                 NoiseNumber seen) {
            return own.cost({counter * errors, coarse_ * errors, noise_.slip ? variance(slip) : 0.0,
                             variance(speed), variance(seen)},
                            now[kFreeShare]);
        };
        double sum = 0.0;
        if (of.way) sum += channel(way_, errors_[0], kSlipWay, kSpeedWay, kSeenWay);
        if (of.turn) sum += channel(turn_, errors_[1], kSlipTurn, kSpeedTurn, kSeenTurn);
        for (std::size_t k = 0; k < kNoises; ++k)
            sum += std::pow((now[k] - guess_[k]) / kPriorWidth, 2) / 2;
        return sum;
    }
    double cost(const NoiseNumbers& now) const { return cost(now, {true, true}); }

    std::vector<std::size_t> moved(bool share) const {
        std::vector<std::size_t> all;
        for (std::size_t k = 0; k <= kFreeShare; ++k) {
            const bool off = (k == kCounter && !noise_.counters) ||
                             ((k == kSlipWay || k == kSlipTurn) && !noise_.slip) ||
                             (k == kFreeShare && !share);
            if (!off) all.push_back(k);
        }
        return all;
    }

    void slopes(NoiseNumbers now, const std::vector<std::size_t>& moved, double* gradient) const {
        for (std::size_t k = 0; k < moved.size(); ++k) {
            double& one = now[moved[k]];
            const double here = one;
            const Touches of = channels_of(moved[k]);
            one = here + kSlopeStep;
            const double up = cost(now, of);
            one = here - kSlopeStep;
            gradient[k] = (up - cost(now, of)) / (2 * kSlopeStep);
            one = here;
        }
    }

  private:
    DriveNoise noise_;
    double coarse_;
    ChannelFilter way_, turn_;
    std::array<double, 2> errors_;
    NoiseNumbers guess_{};
};

class DriveDescent final : public ceres::FirstOrderFunction {
  public:
    DriveDescent(const DriveLikelihood& likelihood, std::vector<std::size_t> moved, const NoiseNumbers& begin)
        : likelihood_(likelihood), moved_(std::move(moved)), begin_(begin) {}
    int NumParameters() const override { return static_cast<int>(moved_.size()); }
    bool Evaluate(const double* x, double* cost, double* gradient) const override {
        const NoiseNumbers now = numbers(x);
        *cost = likelihood_.cost(now);
        if (!std::isfinite(*cost)) return false;
        if (gradient != nullptr) likelihood_.slopes(now, moved_, gradient);
        return true;
    }
    NoiseNumbers numbers(const double* x) const {
        NoiseNumbers now = begin_;
        for (std::size_t k = 0; k < moved_.size(); ++k)
            now[moved_[k]] = x[k];
        return now;
    }

  private:
    const DriveLikelihood& likelihood_;
    std::vector<std::size_t> moved_;
    NoiseNumbers begin_;
};

/// From `at` downhill.
NoiseNumbers descended(const DriveLikelihood& likelihood, const std::vector<std::size_t>& moved,
                       const NoiseNumbers& at) {
    std::vector<double> x;
    for (const std::size_t k : moved)
        x.push_back(at[k]);
    ceres::GradientProblemSolver::Options options;
    options.max_num_iterations = kMostDescents;
    options.line_search_direction_type = ceres::BFGS;
    options.function_tolerance = kCostConverged;
    options.logging_type = ceres::SILENT;
    options.minimizer_progress_to_stdout = false;
    ceres::GradientProblemSolver::Summary summary;
    auto* descent = new DriveDescent(likelihood, moved, at);  // the problem's own
    const ceres::GradientProblem problem(descent);
    ceres::Solve(options, problem, x.data(), &summary);
    return descent->numbers(x.data());
}

/// sd of the share, by the curvature of the cost in all that was moved; the share is the last of these.
double share_sd(const DriveLikelihood& likelihood, const std::vector<std::size_t>& moved,
                const NoiseNumbers& at) {
    const auto n = static_cast<Eigen::Index>(moved.size());
    Eigen::MatrixXd curvature(n, n);
    Eigen::VectorXd up(n), down(n);
    for (Eigen::Index k = 0; k < n; ++k) {
        NoiseNumbers near = at;
        double& one = near[moved[static_cast<std::size_t>(k)]];
        one += kCurvatureStep;
        likelihood.slopes(near, moved, up.data());
        one -= 2 * kCurvatureStep;
        likelihood.slopes(near, moved, down.data());
        curvature.col(k) = (up - down) / (2 * kCurvatureStep);
    }
    curvature = ((curvature + curvature.transpose()) / 2).eval();
    // Along a noise that is next to nothing the cost is flat, or bends the other way by rounding.
    for (Eigen::Index k = 0; k + 1 < n; ++k)
        curvature(k, k) = std::max(curvature(k, k), 1 / (kPriorWidth * kPriorWidth));
    const double variance = curvature.ldlt().solve(Eigen::VectorXd::Unit(n, n - 1))[n - 1];
    return variance > 0 ? std::sqrt(variance) : std::numeric_limits<double>::infinity();
}

}  // namespace

DriveFit fit_drive(const CountedDrive& drive, const DriveNoise& noise, const std::optional<double>& share) {
    const DriveLikelihood likelihood(drive, noise);
    const auto moved = likelihood.moved(!share);
    NoiseNumbers best{};
    double least = std::numeric_limits<double>::infinity();
    // Counter noise and a restless robot may each pass for the other at first: begin with either.
    for (const double more : kCounterBegins) {
        NoiseNumbers at = likelihood.guess();
        at[kCounter] += more;
        at[kSpeedTurn] -= more;
        at[kSpeedWay] -= more;
        at[kFreeShare] = share.value_or(0.0);
        const NoiseNumbers end = descended(likelihood, moved, at);
        const double cost = likelihood.cost(end);
        if (!(cost < least)) continue;
        least = cost;
        best = end;
    }
    DriveFit result;
    result.cost = least;
    result.share = best[kFreeShare];
    if (!share) result.share_sd = share_sd(likelihood, moved, best);
    result.counter_sd = noise.counters ? std::exp(best[kCounter]) : 0.0;
    result.slip_way = noise.slip ? std::exp(best[kSlipWay]) : 0.0;
    result.slip_turn = noise.slip ? std::exp(best[kSlipTurn]) : 0.0;
    result.seen_way = std::exp(best[kSeenWay]);
    result.seen_turn = std::exp(best[kSeenTurn]);
    return result;
}

}  // namespace puckloop::gap
