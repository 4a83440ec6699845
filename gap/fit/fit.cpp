#include "gap/fit/fit.h"

#include <Eigen/Dense>
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kOffset = 0.25;  // (level - level0 + 1/4) has curvature 2 at level0, as the likelihood has
constexpr double kRelativeStep = 2e-5;  // of a prior's width, for differences
constexpr double kNoiseStep = 1e-5;
constexpr double kClaimDoubt = 0.08;  // of ln sd, where the simulator claims one
constexpr int kNewtonRounds = 12;
constexpr double kLongest = 20.0;   // a Newton step, in units of the differences
constexpr double kConverged = 0.1;  // nats that another round must still bring

/// Which numbers a solver moves: scaled model parameters first, then the noise of each observable.
class Layout {
  public:
    Layout(const Model& model, const std::vector<Freed>& freed, bool all_noise) : freed_(freed) {
        for (std::size_t o = 0; o < model.observables().size(); ++o)
            for (int k = 0; k < std::min(noise_parameters(model.observables()[o]), all_noise ? 4 : 1); ++k)
                noise_.emplace_back(o, k);
    }
    std::size_t size() const { return freed_.size() + noise_.size(); }
    std::size_t freed() const { return freed_.size(); }
    std::size_t observable(std::size_t j) const { return noise_[j - freed_.size()].first; }

    void pack(const State& state, double* x) const {
        for (std::size_t j = 0; j < freed_.size(); ++j)
            x[j] = (state.values[static_cast<std::size_t>(freed_[j].index)] - freed_[j].centre) /
                   freed_[j].prior_sd;
        for (std::size_t k = 0; k < noise_.size(); ++k) {
            NoiseParameters copy = state.noise[noise_[k].first];
            x[freed_.size() + k] = noise_parameter(copy, noise_[k].second);
        }
    }
    void unpack(const double* x, State& state) const {
        for (std::size_t j = 0; j < freed_.size(); ++j)
            state.values[static_cast<std::size_t>(freed_[j].index)] =
                std::clamp(freed_[j].centre + x[j] * freed_[j].prior_sd, freed_[j].low, freed_[j].high);
        for (std::size_t k = 0; k < noise_.size(); ++k)
            noise_parameter(state.noise[noise_[k].first], noise_[k].second) = x[freed_.size() + k];
    }
    void bounds(const Model& model, std::size_t j, double& low, double& high) const {
        if (j < freed_.size()) {
            low = (freed_[j].low - freed_[j].centre) / freed_[j].prior_sd;
            high = (freed_[j].high - freed_[j].centre) / freed_[j].prior_sd;
        } else {
            const auto& [o, k] = noise_[j - freed_.size()];
            noise_bounds(model.observables()[o].noise, k, low, high);
        }
    }

  private:
    const std::vector<Freed>& freed_;
    std::vector<std::pair<std::size_t, int>> noise_;
};

/// How far the noise is from what the simulator claims, in units of the claim's own doubt.
double claim_error(const Observable& observable, const NoiseParameters& noise) {
    if (observable.known_sd <= 0) return 0.0;
    const double nu = std::exp(noise.log_tail);
    const double sd = noise.log_sd + 0.5 * std::log(nu / std::max(nu - 2, 0.5));
    return (sd - std::log(observable.known_sd)) / kClaimDoubt;
}

/// All rows as one vector of residuals: shape and other of each row, level of each row (or one for all where
/// the noise is the same in all rows), and the priors.
class Cost final : public ceres::CostFunction {
  public:
    Cost(const Model& model, const Layout& layout, State state, const Weights& weights)
        : model_(model), layout_(layout), state_(std::move(state)), weights_(weights) {
        rich_ = is_rich();
        int rows = 0;
        for (const auto& observable : model.observables()) {
            first_.push_back(rows);
            const int n = static_cast<int>(observable.y.size());
            rows += rich_ ? 3 * n : n + 1;
        }
        priors_ = rows;
        rows += static_cast<int>(layout.freed() + model.observables().size());
        set_num_residuals(rows);
        mutable_parameter_block_sizes()->push_back(static_cast<int>(layout.size()));
        recentre(state_);
    }

    /// Takes the levels at `state` as the centre; returns how far they moved.
    double recentre(const State& state) {
        model_.predict(state.values, prediction_);
        double moved = 0.0;
        centre_.resize(model_.observables().size());
        for (std::size_t o = 0; o < centre_.size(); ++o) {
            row_costs(model_.observables()[o], prediction_[o], state.noise[o], costs_);
            for (std::size_t i = 0; i < centre_[o].size(); ++i)
                moved = std::max(moved, std::abs(costs_.level[i] - centre_[o][i]));
            if (centre_[o].empty()) moved = 1.0;
            centre_[o] = costs_.level;
        }
        return moved;
    }

    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
        const double* x = parameters[0];
        layout_.unpack(x, state_);
        model_.predict(state_.values, prediction_);
        if (!fill(residuals)) return false;
        const auto n = static_cast<std::size_t>(num_residuals()), width = layout_.size();
        for (std::size_t j = 0; j < layout_.freed(); ++j)
            residuals[static_cast<std::size_t>(priors_) + j] = x[j];
        const std::size_t claims = static_cast<std::size_t>(priors_) + layout_.freed();
        for (std::size_t o = 0; o < model_.observables().size(); ++o)
            residuals[claims + o] = claim_error(model_.observables()[o], state_.noise[o]);
        if (jacobians == nullptr || jacobians[0] == nullptr) return true;
        std::fill(jacobians[0], jacobians[0] + n * width, 0.0);
        std::vector<double> moved_x(x, x + width);
        moved_.resize(n);
        for (std::size_t j = 0; j < width; ++j) {
            double low = 0, high = 0;
            layout_.bounds(model_, j, low, high);
            double step = j < layout_.freed() ? kRelativeStep : kNoiseStep;
            if (x[j] + step > high) step = -step;
            moved_x[j] = x[j] + step;
            layout_.unpack(moved_x.data(), state_);
            moved_x[j] = x[j];
            std::size_t from = 0, to = model_.observables().size();
            if (j < layout_.freed()) {
                model_.predict(state_.values, other_);
            } else {
                from = layout_.observable(j);
                to = from + 1;
            }
            for (std::size_t o = from; o < to; ++o) {
                if (!fill_one(o, j < layout_.freed() ? other_[o] : prediction_[o], moved_.data()))
                    return false;
                const auto begin = static_cast<std::size_t>(first_[o]);
                const auto end = o + 1 < first_.size() ? static_cast<std::size_t>(first_[o + 1])
                                                       : static_cast<std::size_t>(priors_);
                for (std::size_t i = begin; i < end; ++i)
                    jacobians[0][i * width + j] = (moved_[i] - residuals[i]) / step;
            }
            if (j >= layout_.freed()) {
                const std::size_t o = layout_.observable(j);
                jacobians[0][(claims + o) * width + j] =
                    (claim_error(model_.observables()[o], state_.noise[o]) - residuals[claims + o]) / step;
            }
            if (j < layout_.freed()) jacobians[0][(static_cast<std::size_t>(priors_) + j) * width + j] = 1.0;
        }
        return true;
    }

  private:
    bool is_rich() const {
        std::vector<double> x(layout_.size());
        layout_.pack(state_, x.data());
        for (std::size_t j = 0; j <= layout_.freed(); ++j) {
            std::vector<double> moved = x;
            if (j < layout_.freed()) moved[j] += moved[j] > 0 ? -1e-3 : 1e-3;
            State state = state_;
            layout_.unpack(moved.data(), state);
            model_.predict(state.values, prediction_);
            for (const Predicted& p : prediction_)
                if (!p.factor.empty() || !p.extra.empty() || !p.lapse.empty() || p.floor > 0 ||
                    p.line_amplitude > 0)
                    return true;
        }
        return false;
    }

    bool fill(double* residuals) const {
        for (std::size_t o = 0; o < model_.observables().size(); ++o)
            if (!fill_one(o, prediction_[o], residuals)) return false;
        return true;
    }

    bool fill_one(std::size_t o, const Predicted& predicted, double* residuals) const {
        row_costs(model_.observables()[o], predicted, state_.noise[o], costs_);
        const std::size_t n = costs_.shape.size();
        double* out = residuals + first_[o];
        double sum = 0.0, counted = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            const double weight = weights_.empty() ? 1.0 : weights_[o][i];
            const double root = weight == 1.0 ? 1.0 : std::sqrt(weight);
            const double above = costs_.level[i] - centre_[o][i] + kOffset;
            const double shape = root * costs_.shape[i];
            if (!std::isfinite(shape)) return false;
            if (rich_) {
                if (!(above > 0.01)) return false;
                out[3 * i] = shape;
                out[3 * i + 1] = root * std::sqrt(2 * above);
                out[3 * i + 2] = costs_.other.empty() ? 0.0 : root * std::sqrt(2 * costs_.other[i]);
            } else {
                out[i] = shape;
                sum += weight * above;
                counted += weight;
            }
        }
        if (rich_) return true;
        if (counted > 0 && !(sum > 0.02 * counted)) return false;
        out[n] = std::sqrt(2 * std::max(sum, 0.0));
        return true;
    }

    const Model& model_;
    const Layout& layout_;
    mutable State state_;
    const Weights& weights_;
    bool rich_ = false;
    int priors_ = 0;
    std::vector<int> first_;
    std::vector<std::vector<double>> centre_;
    mutable Prediction prediction_, other_;
    mutable RowCosts costs_;
    mutable std::vector<double> moved_;
};

ceres::Solver::Options options_for(int iterations) {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    options.max_num_iterations = iterations;
    options.function_tolerance = 1e-7;
    options.gradient_tolerance = 1e-9;
    options.parameter_tolerance = 1e-7;
    options.initial_trust_region_radius = 1e2;
    options.logging_type = ceres::SILENT;
    options.minimizer_progress_to_stdout = false;
    options.num_threads = 1;
    return options;
}

double total(const std::vector<std::vector<double>>& scores, const Weights& weights) {
    double sum = 0.0;
    for (std::size_t o = 0; o < scores.size(); ++o)
        for (std::size_t i = 0; i < scores[o].size(); ++i)
            sum += (weights.empty() ? 1.0 : weights[o][i]) * scores[o][i];
    return sum;
}

/// Newton's steps on the noise of each observable by itself: the solver's steps are good for means and slow
/// for tails and drifts, whose curvature it does not see.
void polish_noise(const Model& model, const Weights& weights, State& state) {
    Prediction prediction;
    model.predict(state.values, prediction);
    RowCosts costs;
    for (std::size_t o = 0; o < model.observables().size(); ++o) {
        const Observable& observable = model.observables()[o];
        const int n = noise_parameters(observable);
        if (n == 0) continue;
        const auto cost = [&](const Eigen::VectorXd& x) {
            NoiseParameters noise;
            for (int k = 0; k < n; ++k)
                noise_parameter(noise, k) = x[k];
            row_costs(observable, prediction[o], noise, costs);
            double sum = 0.0;
            for (std::size_t i = 0; i < costs.shape.size(); ++i)
                sum += (weights.empty() ? 1.0 : weights[o][i]) * costs.cost(i);
            const double off = claim_error(observable, noise);
            return std::isfinite(sum) ? sum + off * off / 2 : 1e300;
        };
        Eigen::VectorXd low(n), high(n), x(n), reach(n);
        for (int k = 0; k < n; ++k) {
            noise_bounds(observable.noise, k, low[k], high[k]);
            reach[k] = k == 1 && observable.noise == NoiseKind::Level ? 0.1 : k == 2 ? 0.05 : 0.01;
            x[k] =
                std::clamp(noise_parameter(state.noise[o], k), low[k] + 2 * reach[k], high[k] - 2 * reach[k]);
        }
        double here = cost(x);
        double damping = 1e-2;
        for (int round = 0; round < kNewtonRounds; ++round) {
            Eigen::VectorXd gradient(n), up(n);
            Eigen::MatrixXd curvature = Eigen::MatrixXd::Zero(n, n);
            for (int k = 0; k < n; ++k) {
                const Eigen::VectorXd step = reach[k] * Eigen::VectorXd::Unit(n, k);
                up[k] = cost(x + step);
                const double down = cost(x - step);
                gradient[k] = (up[k] - down) / 2;  // in units of the reach
                curvature(k, k) = up[k] + down - 2 * here;
            }
            for (int k = 0; k < n; ++k)
                for (int l = 0; l < k; ++l) {
                    const Eigen::VectorXd both =
                        reach[k] * Eigen::VectorXd::Unit(n, k) + reach[l] * Eigen::VectorXd::Unit(n, l);
                    curvature(k, l) = curvature(l, k) = cost(x + both) - up[k] - up[l] + here;
                }
            bool better = false;
            for (int attempt = 0; attempt < 4 && !better; ++attempt) {
                Eigen::MatrixXd damped = curvature;
                for (int k = 0; k < n; ++k)
                    damped(k, k) = std::max(std::abs(curvature(k, k)), 1e-4) * (1 + damping);
                Eigen::VectorXd step = -damped.ldlt().solve(gradient);
                Eigen::VectorXd moved = x;
                for (int k = 0; k < n; ++k)
                    moved[k] = std::clamp(x[k] + std::clamp(step[k], -kLongest, kLongest) * reach[k],
                                          low[k] + 2 * reach[k], high[k] - 2 * reach[k]);
                const double there = cost(moved);
                if (there < here) {
                    better = here - there > kConverged / 4;
                    x = moved;
                    here = there;
                    damping = std::max(damping / 5, 1e-4);
                    if (!better) break;
                } else {
                    damping = std::max(damping * 10, 0.3);
                }
            }
            if (!better) break;
        }
        for (int k = 0; k < n; ++k)
            noise_parameter(state.noise[o], k) = x[k];
    }
}

}  // namespace

State neutral_state(const Model& model) {
    State state{model.neutral(), {}};
    Prediction prediction;
    model.predict(state.values, prediction);
    for (std::size_t o = 0; o < model.observables().size(); ++o)
        state.noise.push_back(first_guess(model.observables()[o], prediction[o]));
    return state;
}

std::vector<RowCosts> costs_at(const Model& model, const State& state, Prediction& prediction) {
    model.predict(state.values, prediction);
    std::vector<RowCosts> costs(model.observables().size());
    for (std::size_t o = 0; o < costs.size(); ++o)
        row_costs(model.observables()[o], prediction[o], state.noise[o], costs[o]);
    return costs;
}

std::vector<std::vector<double>> row_scores(const Model& model, const State& state) {
    Prediction prediction;
    const auto costs = costs_at(model, state, prediction);
    std::vector<std::vector<double>> scores(costs.size());
    for (std::size_t o = 0; o < costs.size(); ++o) {
        scores[o].resize(costs[o].shape.size());
        for (std::size_t i = 0; i < scores[o].size(); ++i)
            scores[o][i] = -costs[o].cost(i);
    }
    return scores;
}

Fitted fit(const Model& model, const std::vector<Freed>& freed, const State& start, const Weights& weights,
           const Effort& effort) {
    const Layout layout(model, freed, effort.noise);
    Fitted result;
    result.state = start;
    std::vector<double> x(std::max<std::size_t>(layout.size(), 1));
    layout.pack(start, x.data());
    for (std::size_t j = 0; j < layout.size(); ++j) {
        double low = 0, high = 0;
        layout.bounds(model, j, low, high);
        x[j] = std::clamp(x[j], low, high);
    }
    layout.unpack(x.data(), result.state);
    if (layout.size() > 0) {
        Cost cost(model, layout, result.state, weights);
        double reached = -INFINITY;
        for (int round = 0; round < effort.rounds; ++round) {
            ceres::Problem::Options problem_options;
            problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
            ceres::Problem problem(problem_options);
            problem.AddResidualBlock(&cost, nullptr, x.data());
            for (std::size_t j = 0; j < layout.size(); ++j) {
                double low = 0, high = 0;
                layout.bounds(model, j, low, high);
                problem.SetParameterLowerBound(x.data(), static_cast<int>(j), low);
                problem.SetParameterUpperBound(x.data(), static_cast<int>(j), high);
            }
            ceres::Solver::Summary summary;
            ceres::Solve(options_for(effort.iterations), &problem, &summary);
            result.iterations += static_cast<int>(summary.iterations.size());
            layout.unpack(x.data(), result.state);
            if (effort.noise) {
                polish_noise(model, weights, result.state);
                layout.pack(result.state, x.data());
            }
            if (round + 1 == effort.rounds) break;
            cost.recentre(result.state);
            const double better = total(row_scores(model, result.state), weights);
            if (better < reached + kConverged) break;
            reached = better;
        }
    }
    result.log_likelihood = total(row_scores(model, result.state), weights);
    for (std::size_t o = 0; o < model.observables().size(); ++o) {
        const double off = claim_error(model.observables()[o], result.state.noise[o]);
        result.log_likelihood -= off * off / 2;
    }
    for (std::size_t j = 0; j < freed.size(); ++j)
        result.log_prior -= x[j] * x[j] / 2;
    return result;
}

}  // namespace puckloop::gap
