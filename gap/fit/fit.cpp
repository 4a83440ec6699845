#include "gap/fit/fit.h"

#include "gap/fit/objective.h"

#include <Eigen/Cholesky>
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace puckloop::gap {

namespace {

constexpr double kRoom = 1e3, kRoomPerRow = 50.0;  // nats that a fit may win
constexpr double kConverged = 0.01;                // nats that a step must bring
constexpr int kMostSearched = 4;                   // places along a step

/// The objective as a least-squares problem: a residual for each number, such that their Jacobian J and
/// residuals r give the objective's curvature (J'J) and gradient (J'r), and one that brings half the sum of
/// squares to the objective's value over a base far below. So the solver's steps are Newton's.
class Adapter final : public ceres::CostFunction {
  public:
    Adapter(Objective& objective, const Layout& layout, double base)
        : objective_(objective), layout_(layout), base_(base) {
        set_num_residuals(static_cast<int>(layout.size()) + 1);
        mutable_parameter_block_sizes()->push_back(static_cast<int>(layout.size()));
    }

    bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
        using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
        const auto width = static_cast<Eigen::Index>(layout_.size());
        Eigen::Map<Eigen::VectorXd> out(residuals, width + 1);
        out.setZero();
        if (jacobians == nullptr || jacobians[0] == nullptr) {
            const double above = objective_.value(parameters[0]) - base_;
            out[width] = std::sqrt(2 * above);
            return std::isfinite(above) && above > 0;
        }
        Eigen::VectorXd gradient;
        Eigen::MatrixXd curvature;
        const double above = objective_.slopes(parameters[0], gradient, curvature) - base_;
        if (!(std::isfinite(above) && above > 0 && gradient.allFinite())) return false;
        // Far from the end a curvature may be next to nothing: no step longer than is sensible.
        for (Eigen::Index j = 0; j < width; ++j)
            curvature(j, j) = std::max(curvature(j, j),
                                       std::abs(gradient[j]) / layout_.longest(static_cast<std::size_t>(j)));
        Eigen::LLT<Eigen::MatrixXd> cholesky(curvature);
        if (cholesky.info() != Eigen::Success) {
            curvature.diagonal() *= 1 + 1e-6;
            cholesky.compute(curvature);
            if (cholesky.info() != Eigen::Success) return false;
        }
        Eigen::VectorXd root = cholesky.matrixL().solve(gradient);
        Eigen::MatrixXd factor = cholesky.matrixU();
        if (const double most = 0.9 * 2 * above; root.squaredNorm() > most) {
            const double shorter = std::sqrt(most / root.squaredNorm());
            root *= shorter;
            factor /= shorter;
        }
        Eigen::Map<RowMajor> jacobian(jacobians[0], width + 1, width);
        jacobian.setZero();
        jacobian.topRows(width) = factor;
        out.head(width) = root;
        out[width] = std::sqrt(2 * above - root.squaredNorm());
        return true;
    }

  private:
    Objective& objective_;
    const Layout& layout_;
    double base_;
};

ceres::Solver::Options options_for(int iterations, double room) {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    options.max_num_iterations = iterations;
    options.function_tolerance = kConverged / room;
    options.gradient_tolerance = 1e-9;
    options.parameter_tolerance = 1e-9;
    options.initial_trust_region_radius = 1e4;
    options.jacobi_scaling = false;
    // Steps that a bound cuts are searched along by values alone: derivatives cost ten times as much.
    options.line_search_interpolation_type = ceres::QUADRATIC;
    options.max_num_line_search_step_size_iterations = kMostSearched;
    options.logging_type = ceres::SILENT;
    options.minimizer_progress_to_stdout = false;
    options.num_threads = 1;
    return options;
}

}  // namespace

State neutral_state(const Model& model) {
    State state{model.neutral(), {}};
    const Prediction prediction = model.predicted(state.values);
    for (std::size_t o = 0; o < model.observables().size(); ++o)
        state.noise.push_back(first_guess(model.observables()[o], prediction[o]));
    return state;
}

double cost_of(const Model& model, const State& state, const Prediction& prediction) {
    double sum = 0.0;
    for (const RowCosts& costs : costs_at(model, state, prediction))
        sum = std::accumulate(costs.cost.begin(), costs.cost.end(), sum);
    return sum;
}

std::vector<RowCosts> costs_at(const Model& model, const State& state, const Prediction& prediction) {
    std::vector<RowCosts> costs(model.observables().size());
    for (std::size_t o = 0; o < costs.size(); ++o)
        row_costs(model.observables()[o], prediction[o], state.noise[o], costs[o]);
    return costs;
}

double log_likelihood(const Model& model, const State& state) {
    const Layout none(model, {}, Effort{.noise = false});
    return -Objective(model, none, state, kEven).value(none.packed(state).data());
}

Fitted fit(const Model& model, const std::vector<Freed>& freed, const State& start, const Weights& weights,
           const Effort& effort) {
    const Layout layout(model, freed, effort);
    Fitted result;
    result.state = start;
    std::vector<double> x = layout.packed(start);
    for (std::size_t j = 0; j < layout.size(); ++j) {
        const auto [low, high] = layout.bounds(j);
        x[j] = std::clamp(x[j], low, high);
    }
    Objective objective(model, layout, start, weights);
    double cost = objective.value(x.data());
    if (layout.size() > 0 && std::isfinite(cost)) {
        double room = kRoom;
        for (const Observable& observable : model.observables())
            room += kRoomPerRow * static_cast<double>(observable.y.size());
        Adapter adapter(objective, layout, cost - room);
        ceres::Problem::Options problem_options;
        problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
        ceres::Problem problem(problem_options);
        problem.AddResidualBlock(&adapter, nullptr, x.data());
        for (std::size_t j = 0; j < layout.size(); ++j) {
            const auto [low, high] = layout.bounds(j);
            problem.SetParameterLowerBound(x.data(), static_cast<int>(j), low);
            problem.SetParameterUpperBound(x.data(), static_cast<int>(j), high);
        }
        ceres::Solver::Summary summary;
        ceres::Solve(options_for(effort.iterations, room), &problem, &summary);
        cost = objective.value(x.data());
    }
    layout.unpack(x.data(), result.state);
    double log_prior = 0.0;
    for (std::size_t j = 0; j < layout.freed(); ++j)
        log_prior -= prior_cost(x[j]);
    result.log_likelihood = -cost - log_prior;
    return result;
}

}  // namespace puckloop::gap
