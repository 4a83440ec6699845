#pragma once
// What was chosen and diagnosed, as the numbers that the decision rests on.

#include "gap/pipeline/diagnose.h"

#include <cstdint>

namespace puckloop::gap {

/// Without what is dear and asked only of causes that stand so far: roles and confirmation (judge.h).
Grounds grounds_of(const Study& study, const Chosen& chosen, const Diagnosis& diagnosis, std::uint64_t seed);

/// The end of its plausible range at which a fitted parameter stands; NaN: at none.
double end_of_range(const Study& study, const Fit& fit, const Freed& freed);

/// Of all that is gained, the share that may be left. Of sums more: their free forms act on single steps, and
/// cannot say what adds up.
double share_allowed(const Study& study);

}  // namespace puckloop::gap
