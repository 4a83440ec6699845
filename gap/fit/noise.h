#pragma once
// The noise of an observable: its size, errors carried over, heavy tails. gap/fit/filter.h says what a row
// adds to those before it, gap/fit/likelihood.h how likely that is.

#include "gap/models/model.h"

#include <utility>

namespace puckloop::gap {

/// Free numbers of one observable's noise.
struct NoiseParameters {
    double log_sd = 0.0;  ///< of one row, observable's unit
    double carry =
        0.0;  ///< Carry: share of the previous error kept. Level: ln(drift variance / noise variance)
    double log_tail = 3.0;  ///< ln of Student's degrees of freedom
    double memory = 0.0;    ///< Level only: share of the previous measurement error kept
};
/// How many of the four an observable's noise has free.
int noise_parameters(const Observable& observable);
double& noise_parameter(NoiseParameters& noise, int index);
/// Least and most of each, by kind of noise.
std::pair<double, double> noise_bounds(NoiseKind kind, int index);

/// Robust first guess from the residuals of a prediction.
NoiseParameters first_guess(const Observable& observable, const Predicted& predicted);

/// Scale of the noise in each row: of Student's t, so less than its sd. What is added in quadrature is a sd.
class RowSize {
  public:
    /// Keeps references to `predicted`.
    RowSize(const Observable& observable, const Predicted& predicted, const NoiseParameters& noise);
    double at(std::size_t i) const { return even_ ? sd_ : of(i); }

  private:
    double of(std::size_t i) const;

    const Predicted& predicted_;
    double own_, tail_, rounding_, sd_ = 0.0;
    bool even_;
};
/// Of an Event the sd of what happens or not.
double row_sd(const Observable& observable, const Predicted& predicted, const NoiseParameters& noise,
              std::size_t i);

/// Are errors, rounding included, less than half a step wide? Then how readings fall on either side of a step
/// shows in their means and sizes: a difference of less than a step may be its doing.
bool is_within_step(const Observable& observable, const NoiseParameters& noise);

/// Is a sum's own noise so much less than its rounding that its rows show the rounding only?
bool is_rounding(const Observable& observable, const NoiseParameters& noise);

}  // namespace puckloop::gap
