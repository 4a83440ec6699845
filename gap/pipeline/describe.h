#pragma once
// The verdict in numbers and words, from what was decided. Changes nothing that was decided but for one
// thing: where another effect does as well in the place of a cause that matters, the name becomes "cannot
// tell".

#include "gap/pipeline/judge.h"

#include <cstddef>
#include <cstdint>

namespace puckloop::gap {

Verdict verdict_of(const Study& study, Judged judged, std::uint64_t seed);

/// `delta_bic` of a set over the one it adds `parameters` to, of so many rows. No less than what these cost
/// where the set can be all that the other is; less by more than 10 (very strong, Kass and Raftery 1995)
/// where the solver ended short of that, or the effect's range does not hold the simulator's value.
bool fit_failed(double delta_bic, std::size_t parameters, std::size_t rows);

}  // namespace puckloop::gap
