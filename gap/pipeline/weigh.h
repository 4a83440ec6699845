#pragma once
// What was chosen and diagnosed, as the numbers that the decision rests on.

#include "gap/pipeline/diagnose.h"

#include <cstdint>

namespace puckloop::gap {

/// Without what is dear and asked only of causes that stand so far: roles and confirmation (judge.h).
Grounds grounds_of(const Study& study, const Chosen& chosen, const Diagnosis& diagnosis, std::uint64_t seed);

/// The end of the range [low, high] at which `value` stands, as a share of the range: of its logarithm where
/// a range of one sign spans more than ten to one (20 to 2000 s), else of itself. NaN: at none. An end of 0
/// is a mechanism that is not there, one of 1 above it all of a share, and one beside `neutral` is the
/// simulator itself: none of them counts.
double range_end(double value, double low, double high, double neutral);

/// The end of its plausible range at which a fitted parameter stands; NaN: at none.
double end_of_range(const Study& study, const Fit& fit, const Freed& freed);

/// Of all that is gained, the share that may be left. Of sums more: their free forms act on single steps, and
/// cannot say what adds up.
double share_allowed(const Study& study);

}  // namespace puckloop::gap
