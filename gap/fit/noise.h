#pragma once
// The noise of an observable: carried-over errors, heavy tails, lapses, clipping, quantisation, a spectral
// line. Each row's cost (minus log likelihood) is split into parts that are non-negative by construction, so
// that a least-squares solver sees the true likelihood.
//
// Deviations: 1. rows beside a clipped one count as the first of a chain. 2. The tails of innovations are
// Student's t also where the line or the level is filtered.

#include "gap/models/model.h"

#include <vector>

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
/// Bounds of the three, by kind of noise.
void noise_bounds(NoiseKind kind, int index, double& low, double& high);

/// A row's cost is shape^2 / 2 + level + other.
struct RowCosts {
    std::vector<double> shape;  ///< signed root deviance of the innovation
    std::vector<double> level;  ///< ln of the innovation's scale and the density's constant; any sign
    std::vector<double> other;  ///< >= 0: lapses and dead zone; empty when nothing of the kind is modelled
    std::vector<double> innovation;  ///< standardised; of a clipped row the middle of what it may be

    double cost(std::size_t i) const {
        return shape[i] * shape[i] / 2 + level[i] + (other.empty() ? 0.0 : other[i]);
    }
};

void row_costs(const Observable& observable, const Predicted& predicted, const NoiseParameters& noise,
               RowCosts& out);

/// Robust first guess from the residuals of a prediction.
NoiseParameters first_guess(const Observable& observable, const Predicted& predicted);

/// sd of the noise in a row.
double row_sd(const Observable& observable, const Predicted& predicted, const NoiseParameters& noise,
              std::size_t i);

}  // namespace puckloop::gap
