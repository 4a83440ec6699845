#pragma once
// What is left after the best model: the structures that chance does not explain.

#include "gap/data/experiment.h"
#include "gap/verdict/verdict.h"

#include <cstdint>
#include <vector>

namespace puckloop::gap {

/// Structures of the series' innovations after the fit that chance does not explain (corrected over all
/// observables), the surest first.
std::vector<Leftover> leftovers_of(const Experiment& experiment, const std::vector<Series>& series,
                                   std::uint64_t seed, double level);

}  // namespace puckloop::gap
