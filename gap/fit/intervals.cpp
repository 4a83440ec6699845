#include "gap/fit/intervals.h"

#include "gap/fit/objective.h"
#include "gap/stats/tails.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kSide = 0.95;       // of a 90 % interval
constexpr double kSoftEdge = 0.012;  // the model's edge is soft, 0.4 % wide: a sharp one may lie 3 widths on
constexpr int kLooks = 48;
constexpr double kLeastRest = 0.5;      // of the information, at least, that is left without a block
constexpr double kNearest = 1e-3;       // of the reach, the first look
constexpr double kWorthFitting = 30.0;  // nats: what a fit that begins beside a period's alias may win

/// A threshold between two speeds that were tried moves no row until it meets one of them: slopes say nothing
/// of it, and what bounds it is where the likelihood falls off. How far from the fitted value, up (1) or down
/// (-1), no further than `reach`.
double fall_off(const Study& study, const Fit& fit, std::size_t index, double quantile, double reach,
                int side) {
    State state = fit.fitted.state;
    const double value = state.values[index];
    const double lost = quantile * quantile / 2, here = log_likelihood(study.model(), state);
    for (int k = 0; k < kLooks; ++k) {
        const double way = reach * std::pow(kNearest, 1 - (k + 1.0) / kLooks);
        state.values[index] = value + side * way;
        if (log_likelihood(study.model(), state) < here - lost)
            return std::min(way + kSoftEdge * value, reach);
    }
    return reach;
}

/// Where else a fit of this parameter was begun or may end, if what it ends at there is as likely as the fit
/// itself, as far as the interval goes: rows that cannot part two values (a period and its multiples) leave
/// both. Rising.
std::vector<double> as_likely(const Study& study, const Fit& fit, std::size_t j, double lost, double reach) {
    const auto index = fit.freed[j].index;
    const double value = fit.fitted.state.values[index], here = fit.fitted.log_likelihood;
    std::vector<double> others;
    const auto look_at = [&](double start, double least) {
        State state = fit.fitted.state;
        state.values[index] = start;
        if (std::abs(start - value) <= reach || !(log_likelihood(study.model(), state) > least)) return;
        const Fitted there = puckloop::gap::fit(study.model(), fit.freed, state, {}, kQuick);
        const double other = there.state.values[index];
        const bool known = std::ranges::any_of(others, [&](double one) {
            return std::abs(one - other) <= 2 * std::max(reach, fit.freed[j].resolution);
        });
        if (!known && there.log_likelihood > here - lost && std::abs(other - value) > reach)
            others.push_back(other);
    };
    for (const std::size_t effect : fit.effects) {
        const Candidate& candidate = study.candidates()[effect];
        if (candidate.freed.size() != 1 || candidate.freed[0].index != fit.freed[j].index) continue;
        for (const auto& start : candidate.starts)
            look_at(start[0], -INFINITY);
    }
    for (const double start : study.model().aliases(study.model().parameters()[index].name, value))
        if (start >= fit.freed[j].low && start <= fit.freed[j].high) look_at(start, here - kWorthFitting);
    std::ranges::sort(others);
    return others;
}

/// Covariance of a fit as the blocks say it: each block's pull on a fit that it had no part in (the
/// jackknife, CR3: Cameron and Miller, J. Hum. Resour. 50, 2015), since a block that weighs much draws the
/// fit to itself. `g`: gradient of each row's cost; a block's information is taken from its rows' gradients.
Eigen::MatrixXd left_out_by_block(const Blocks& blocks, const Eigen::MatrixXd& g,
                                  const Eigen::MatrixXd& inverse) {
    const Eigen::Index p = g.cols();
    if (p == 0) return inverse;  // events alone have no noise that is fitted
    const Eigen::LLT<Eigen::MatrixXd> factor(inverse);
    if (factor.info() != Eigen::Success) return inverse;
    const Eigen::MatrixXd root = factor.matrixL();
    std::vector<Eigen::MatrixXd> loading(blocks.count, Eigen::MatrixXd::Zero(p, p));
    Eigen::MatrixXd pull = Eigen::MatrixXd::Zero(p, static_cast<Eigen::Index>(blocks.count));
    const Eigen::MatrixXd scaled = g * root;
    Eigen::Index at = 0;
    for (const auto& of : blocks.of)
        for (const std::uint32_t block : of) {
            pull.col(block) += scaled.row(at).transpose();
            loading[block].selfadjointView<Eigen::Lower>().rankUpdate(scaled.row(at++).transpose());
        }
    for (std::size_t b = 0; b < blocks.count; ++b) {
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(loading[b]);
        const Eigen::VectorXd rest = (1 - eigen.eigenvalues().array()).max(kLeastRest).inverse().matrix();
        const auto k = static_cast<Eigen::Index>(b);
        pull.col(k) =
            eigen.eigenvectors() * rest.asDiagonal() * eigen.eigenvectors().transpose() * pull.col(k);
    }
    pull.colwise() -= pull.rowwise().mean().eval();
    const auto count = static_cast<double>(blocks.count);
    const Eigen::MatrixXd moved = root * pull;
    return moved * moved.transpose() * ((count - 1) / count);
}

}  // namespace

Precision precision_of(const Study& study, const Fit& fit) {
    const Layout layout(study.model(), fit.freed, kThorough);
    const std::vector<double> x = layout.packed(fit.fitted.state);
    Eigen::VectorXd gradient;
    Eigen::MatrixXd information, g;
    Objective(study.model(), layout, fit.fitted.state, kEven).slopes(x.data(), gradient, information, &g);
    const auto n = static_cast<Eigen::Index>(fit.freed.size());
    const Eigen::MatrixXd inverse =
        information.ldlt().solve(Eigen::MatrixXd::Identity(information.rows(), information.cols()));
    const auto count = static_cast<double>(study.blocks().count);
    const Eigen::MatrixXd sandwich = left_out_by_block(study.blocks(), g, inverse);
    Precision result;
    result.quantile = stats::student_quantile(kSide, std::max(count - 1, 2.0));
    result.correlation = Eigen::MatrixXd::Identity(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
        const double variance = (inverse(j, j) + sandwich(j, j)) / 2;
        result.sd.push_back(std::sqrt(std::max(variance, 0.0)) *
                            fit.freed[static_cast<std::size_t>(j)].prior_sd);
        for (Eigen::Index k = 0; k < n; ++k)
            result.correlation(j, k) =
                inverse(j, k) / std::sqrt(std::max(inverse(j, j) * inverse(k, k), 1e-300));
    }
    return result;
}

Interval interval_of(const Study& study, const Fit& fit, const Precision& precision, std::size_t j) {
    const Freed& freed = fit.freed[j];
    const auto index = freed.index;
    const double value = fit.fitted.state.values[index];
    const double reach = std::max(precision.quantile * precision.sd[j], freed.resolution);
    // What cannot be negative (rates, noise, times) is about symmetric in its root, not in itself: a rate
    // seen in few events may be twice as high, hardly zero.
    const bool one_sided = freed.low == study.model().parameters()[index].neutral && freed.low == 0.0;
    const double shift = one_sided ? reach * reach / (4 * std::max(value, reach)) : 0.0;
    if (freed.threshold) {
        const double most = precision.quantile * freed.prior_sd;
        return {
            value - fall_off(study, fit, index, precision.quantile, std::min(most, value - freed.low), -1),
            value + fall_off(study, fit, index, precision.quantile, std::min(most, freed.high - value), 1),
            {}};
    }
    const double low = !one_sided          ? value - reach
                       : reach < 2 * value ? value * std::pow(1 - reach / (2 * value), 2)
                                           : 0.0;
    Interval interval{std::max(low, freed.low), std::min(value + reach + shift, freed.high), {}};
    const double lost = precision.quantile * precision.quantile / 2;
    // All of a share is an end of what there is, where slopes say nothing of what lies beyond: it belongs to
    // the interval unless the likelihood falls off before it.
    if (freed.low == 0.0 && freed.high == 1.0 && interval.high < 1.0) {
        State all = fit.fitted.state;
        all.values[index] = 1.0;
        if (log_likelihood(study.model(), all) > fit.fitted.log_likelihood - lost) interval.high = 1.0;
    }
    interval.as_likely = as_likely(study, fit, j, lost, reach);
    for (const double other : interval.as_likely) {
        // A longer period is known as well in parts of itself, and no better.
        const double width = reach * std::max(value != 0.0 ? std::abs(other / value) : 1.0, 1.0);
        interval.low = std::max(std::min(interval.low, other - width), freed.low);
        interval.high = std::min(std::max(interval.high, other + width), freed.high);
    }
    return interval;
}

}  // namespace puckloop::gap
