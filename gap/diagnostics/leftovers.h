#pragma once
// What is left after the best model: the structures that chance does not explain.

#include "gap/data/experiment.h"
#include "gap/verdict/verdict.h"

#include <cstdint>
#include <vector>

namespace puckloop::gap {

struct Left {
    std::vector<Leftover> structures;  ///< the surest first
    double gain = 0.0;  ///< nats that the largest sure structure of each observable would gain, together
};

/// Structures of the series' innovations after the fit that chance does not explain (corrected over all
/// observables) at `level`; those at `sure` have a gain. `quanta`: the step to which each observable is
/// rounded; a structure smaller than it is what rounding makes.
Left leftovers_of(const Experiment& experiment, const std::vector<Series>& series,
                  const std::vector<double>& quanta, std::uint64_t seed, double level, double sure);

}  // namespace puckloop::gap
