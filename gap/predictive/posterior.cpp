#include "gap/predictive/posterior.h"

#include "gap/fit/objective.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

/// Back into low..high by reflection; what lies farther out than the range is wide, at the end.
double folded(double value, double low, double high) {
    if (value < low) value = 2 * low - value;
    if (value > high) value = 2 * high - value;
    return std::clamp(value, low, high);
}

}  // namespace

std::vector<State> posterior_states(const Model& model, const std::vector<Freed>& freed, const State& mode,
                                    std::size_t count, RandomStream& random) {
    const Layout layout(model, freed, kThorough);
    const auto size = static_cast<Eigen::Index>(layout.size());
    if (size == 0) return std::vector<State>(count, mode);
    const std::vector<double> fitted = layout.packed(mode);
    const Eigen::Map<const Eigen::VectorXd> best(fitted.data(), size);
    Objective objective(model, layout, mode, kEven);
    Eigen::VectorXd gradient;
    Eigen::MatrixXd information;
    double here = -objective.slopes(best.data(), gradient, information);  // log posterior over proposal
    const Eigen::LLT<Eigen::MatrixXd> root(information);
    std::vector<State> states;
    State state = mode;
    while (states.size() < count) {
        Eigen::VectorXd normal(size);
        for (double& one : normal)
            one = random.normal();
        Eigen::VectorXd proposed = best + root.matrixU().solve(normal);
        for (std::size_t j = 0; j < layout.size(); ++j) {
            const auto [low, high] = layout.bounds(j);
            double& one = proposed[static_cast<Eigen::Index>(j)];
            one = folded(one, low, high);
        }
        const double there = -objective.value(proposed.data()) + normal.squaredNorm() / 2;
        if (std::log(1 - random.uniform()) < there - here) {  // never where the model makes no sense
            here = there;
            layout.unpack(proposed.data(), state);
        }
        states.push_back(state);
    }
    return states;
}

}  // namespace puckloop::gap
