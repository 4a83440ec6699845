#include "gap/fit/intervals.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kStep = 1e-3;  // of a prior's width
constexpr double kNoiseStep = 1e-4;

/// Gradient of every row's cost with respect to freed parameters (scaled by their priors) and noise.
class Gradients {
  public:
    Gradients(const Study& study, const Fit& fit) : study_(study), fit_(fit) {
        for (std::size_t o = 0; o < study.model().observables().size(); ++o)
            for (int k = 0; k < noise_parameters(study.model().observables()[o]); ++k)
                noise_.emplace_back(o, k);
    }
    std::size_t size() const { return fit_.freed.size() + noise_.size(); }

    Eigen::MatrixXd all() const {
        Eigen::MatrixXd gradients = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(study_.rows()),
                                                          static_cast<Eigen::Index>(size()));
        for (std::size_t j = 0; j < size(); ++j) {
            double reach = 0.0;
            const Eigen::VectorXd up = costs(j, 1, reach), down = costs(j, -1, reach);
            if (reach > 0) gradients.col(static_cast<Eigen::Index>(j)) = (up - down) / reach;
        }
        return gradients;
    }

  private:
    Eigen::VectorXd costs(std::size_t j, int sign, double& reach) const {
        State state = fit_.fitted.state;
        if (j < fit_.freed.size()) {
            const Freed& freed = fit_.freed[j];
            double& value = state.values[static_cast<std::size_t>(freed.index)];
            const double moved = std::clamp(value + sign * kStep * freed.prior_sd, freed.low, freed.high);
            reach += std::abs(moved - value) / freed.prior_sd;
            value = moved;
        } else {
            const auto& [o, k] = noise_[j - fit_.freed.size()];
            noise_parameter(state.noise[o], k) += sign * kNoiseStep;
            reach += kNoiseStep;
        }
        Prediction prediction;
        const auto rows = costs_at(study_.model(), state, prediction);
        Eigen::VectorXd all(static_cast<Eigen::Index>(study_.rows()));
        Eigen::Index at = 0;
        for (const RowCosts& one : rows)
            for (std::size_t i = 0; i < one.cost.size(); ++i)
                all[at++] = one.cost[i];
        return all;
    }

    const Study& study_;
    const Fit& fit_;
    std::vector<std::pair<std::size_t, int>> noise_;
};

/// Student's t, 95 %, by degrees of freedom (Cornish-Fisher).
double t_quantile(double freedom) {
    const double z = 1.6449;
    return z + (z * z * z + z) / (4 * freedom) +
           (5 * std::pow(z, 5) + 16 * z * z * z + 3 * z) / (96 * freedom * freedom);
}

}  // namespace

Precision precision_of(const Study& study, const Fit& fit) {
    const Gradients gradients(study, fit);
    const Eigen::MatrixXd g = gradients.all();
    const Eigen::Index p = g.cols(), n = static_cast<Eigen::Index>(fit.freed.size());
    Eigen::MatrixXd blocks = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(study.blocks().count), p);
    Eigen::Index at = 0;
    for (const auto& of : study.blocks().of)
        for (const std::uint32_t block : of)
            blocks.row(block) += g.row(at++);
    Eigen::MatrixXd information = g.transpose() * g;
    for (Eigen::Index j = 0; j < p; ++j)
        information(j, j) += j < n ? 1.0 : 1e-6;  // the prior
    const Eigen::MatrixXd inverse = information.ldlt().solve(Eigen::MatrixXd::Identity(p, p));
    const auto count = static_cast<double>(study.blocks().count);
    blocks.rowwise() -= blocks.colwise().mean().eval();
    const Eigen::MatrixXd between = blocks.transpose() * blocks * (count / std::max(count - 1, 1.0));
    const Eigen::MatrixXd sandwich = inverse * between * inverse;
    Precision result;
    result.quantile = t_quantile(std::max(count - 1, 2.0));
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

}  // namespace puckloop::gap
