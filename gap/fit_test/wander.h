#pragma once
// Do sums wander more than the simulator's can? Beside a fitted model each sum may go astray by a random
// walk, and the robot's heading by what its tracker keeps: a discrepancy that no covariate has to explain
// (Kennedy and O'Hagan 2001; a Brownian motion for their Gaussian process). Held-out score of the fit as it
// is over that of the same fit with both forbidden: by so many nats chance is excluded
// (gap/evidence/criterion.h).

#include "gap/findings/findings.h"
#include "gap/fit/study.h"

#include <vector>

namespace puckloop::gap {

inline constexpr const char* kWanderCovariate = "course of a run";

/// Of each steady observable that wanders beside the fit: a structure, p corrected for how many there are.
/// Only those worth reporting.
std::vector<Leftover> wandering(const Study& study, const Fit& fit);

}  // namespace puckloop::gap
