#pragma once
// What is left after the best model, and whether a free-form correction would say much more than the
// catalogue did.

#include "gap/fit/study.h"
#include "gap/verdict.h"

#include <cstdint>
#include <vector>

namespace puckloop::gap {

/// A structure that is left with what a free-form correction along its covariate would gain.
struct LeftStructure {
    Leftover told;
    double relative = 0.0;  ///< size over the residual's scale
    double gain = 0.0;      ///< log likelihood, nats; 0 where the structure is not one of the mean
};

/// Structures of the series' innovations after the fit that chance does not explain (corrected over all
/// observables), the surest first.
std::vector<LeftStructure> leftovers_of(const Experiment& experiment, const std::vector<Series>& series,
                                        std::uint64_t seed, double level);

}  // namespace puckloop::gap
