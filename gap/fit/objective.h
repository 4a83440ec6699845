#pragma once
// What a fit minimises, as a function of the numbers it moves: minus the weighted log likelihood of all rows,
// the weak priors, and how far the noise is from what the simulator claims. With its gradient and a curvature
// that is expected over rows (Fisher's), so it is never negative and knows the tails' and drifts' as well.

#include "gap/fit/layout.h"
#include "gap/fit/likelihood.h"

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <vector>

namespace puckloop::gap {

// The weak prior of a freed parameter: Student's t with two degrees of freedom, so that a value far out that
// the data knows well is not pulled back, as a normal prior would.

/// Minus its log without constants, `x` prior widths from the centre.
inline double prior_cost(double x) {
    return 1.5 * std::log1p(x * x / 2);
}
inline double prior_slope(double x) {
    return 3 * x / (2 + x * x);
}
/// Of the parabola with this slope that lies above the cost elsewhere: never negative.
inline double prior_curvature(double x) {
    return 3 / (2 + x * x);
}

/// How far the noise is from what the simulator claims, in units of the claim's own doubt.
double claim_error(const Observable& observable, const NoiseParameters& noise);

class Objective {
  public:
    /// `base` gives all numbers that are not moved. All references must outlive it.
    Objective(const Model& model, const Layout& layout, State base, const Weights& weights);

    /// Not finite where the model makes no sense.
    double value(const double* x);
    /// The same with derivatives. `rows`, when asked for, receives the gradient of every row's own cost (rows
    /// of all observables one after another), priors left out.
    double slopes(const double* x, Eigen::VectorXd& gradient, Eigen::MatrixXd& curvature,
                  Eigen::MatrixXd* rows = nullptr);

  private:
    struct Base {
        Innovations innovations;
        RowSlopes rows;
        std::vector<double> cost;  ///< empty until it is needed
        Predicted filled;          ///< what the innovations are of; of an observable whose noise is known
        double sum = 0.0;
    };
    /// How one moved number changes the rows of one observable.
    struct Column {
        std::size_t number = 0;
        bool scales = false;  ///< `scale` is not all 0
        Eigen::VectorXd shift, scale, other, gradient;
    };
    /// A number moved a little, as one observable sees it.
    struct Moved {
        std::size_t number = 0;
        const Predicted* predicted = nullptr;
        NoiseParameters noise;
        double step = 0.0;
        bool tail = false;  ///< the number is the noise's degrees of freedom
    };
    double fill(std::size_t o);
    double priors(const double* x) const;
    double weight(std::size_t o, std::size_t i) const { return weights_.empty() ? 1.0 : weights_[o][i]; }
    void take_differences(std::size_t o, const std::vector<Moved>& moved);
    void difference(std::size_t o, const Moved& moved, const Innovations& other);
    void gather(std::size_t o, Eigen::VectorXd& gradient, Eigen::MatrixXd& curvature) const;
    void gather_mixed(std::size_t o, const Eigen::VectorXd& weights, Eigen::VectorXd& gradient,
                      Eigen::MatrixXd& curvature) const;

    const Model& model_;
    const Layout& layout_;
    State state_;
    const Weights& weights_;
    std::vector<double> last_x_;  ///< where value() was asked last
    double last_value_ = 0.0;
    Prediction prediction_;
    std::array<Prediction, kLanes> moved_;
    std::vector<Base> bases_;
    std::vector<NoiseParameters> base_noise_;   ///< that the bases' derivatives are taken at
    std::vector<std::vector<Column>> columns_;  ///< an observable each
    std::array<Innovations, kLanes> other_;
    std::vector<double> other_cost_;
};

}  // namespace puckloop::gap
