#pragma once
// States drawn from the approximate posterior of a fit.

#include "base/random.h"
#include "gap/fit/fit.h"

#include <vector>

namespace puckloop::gap {

/// `count` states: an independence chain (Tierney, Ann. Stat. 22, 1994) that begins at `mode`, with proposals
/// from the normal law of the fit's curvature, folded at the ends of the ranges. Model parameters, nuisances
/// and noise are drawn together.
std::vector<State> posterior_states(const Model& model, const std::vector<Freed>& freed, const State& mode,
                                    std::size_t count, RandomStream& random);

}  // namespace puckloop::gap
