#include "gap/fit/intervals.h"

#include "gap/fit/objective.h"
#include "gap/stats/tails.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kSide = 0.95;  // of a 90 % interval
constexpr double kSoftEdge =
    0.012;  // the model's edge is soft, 0.4 % wide: a sharp one may lie three of these on
constexpr int kLooks = 48;
constexpr double kNearest = 1e-3;  // of the reach, the first look

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

}  // namespace

Precision precision_of(const Study& study, const Fit& fit) {
    const Layout layout(study.model(), fit.freed, true);
    std::vector<double> x(std::max<std::size_t>(layout.size(), 1));
    layout.pack(fit.fitted.state, x.data());
    const Weights even;
    Eigen::VectorXd gradient;
    Eigen::MatrixXd information, g;
    Objective(study.model(), layout, fit.fitted.state, even).slopes(x.data(), gradient, information, &g);
    const Eigen::Index p = g.cols(), n = static_cast<Eigen::Index>(fit.freed.size());
    Eigen::MatrixXd blocks = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(study.blocks().count), p);
    Eigen::Index at = 0;
    for (const auto& of : study.blocks().of)
        for (const std::uint32_t block : of)
            blocks.row(block) += g.row(at++);
    const Eigen::MatrixXd inverse = information.ldlt().solve(Eigen::MatrixXd::Identity(p, p));
    const auto count = static_cast<double>(study.blocks().count);
    blocks.rowwise() -= blocks.colwise().mean().eval();
    const Eigen::MatrixXd between = blocks.transpose() * blocks * (count / std::max(count - 1, 1.0));
    const Eigen::MatrixXd sandwich = inverse * between * inverse;
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
    const auto index = static_cast<std::size_t>(freed.index);
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
            value + fall_off(study, fit, index, precision.quantile, std::min(most, freed.high - value), 1)};
    }
    return {std::max(value - reach + shift, freed.low), std::min(value + reach + shift, freed.high)};
}

}  // namespace puckloop::gap
