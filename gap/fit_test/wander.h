#pragma once
// Do sums wander more than the simulator's can? Beside a fitted model each sum may go astray by a random
// walk, and the robot's heading by what its tracker keeps: a discrepancy that no covariate has to explain
// (Kennedy and O'Hagan 2001; a Brownian motion for their Gaussian process). Held-out score of the fit as it
// is over that of the same fit with both forbidden: by so many nats chance is excluded
// (gap/evidence/criterion.h).

#include "gap/fit/study.h"
#include "gap/verdict/verdict.h"

#include <vector>

namespace puckloop::gap {

inline constexpr const char* kWanderCovariate = "course of a run";

/// What a walk of one steady observable gains on held-out runs over none.
struct WalkBeside {
    std::size_t observable = 0;
    Gain gain;             ///< nats
    double p_value = 1.0;  ///< corrected for how many steady ones there are
};

/// One each, in the model's order.
std::vector<WalkBeside> walks_beside(const Study& study, const Fit& fit);

/// Those worth reporting, in words.
std::vector<Leftover> wandering(const Study& study, const Fit& fit, const std::vector<WalkBeside>& walks);

}  // namespace puckloop::gap
