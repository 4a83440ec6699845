#pragma once
// Data as a fitted model makes it.
//
// Deviations: 1. an outlier is carried over to the next rows as other errors are, as the likelihood has it
// (a lapse is not). 2. Where values do not keep to the instrument's step (turned sums), rounding is part of
// the errors.

#include "base/random.h"
#include "gap/fit/noise.h"

#include <vector>

namespace puckloop::gap {

/// Values of an observable in place of `observable.y`, which only says where sums begin and whether values
/// keep to the instrument's step: errors by the fitted law, then rounded, cut and clipped.
std::vector<double> replicated(const Observable& observable, const Predicted& predicted,
                               const NoiseParameters& noise, RandomStream& random);

}  // namespace puckloop::gap
