#pragma once
// The verdict in numbers and words, from what was decided. Changes nothing that was decided but for one
// thing: where another effect does as well in the place of a cause that matters, the name becomes "cannot
// tell".

#include "gap/pipeline/judge.h"

#include <cstdint>

namespace puckloop::gap {

Verdict verdict_of(const Study& study, Judged judged, std::uint64_t seed);

}  // namespace puckloop::gap
