#pragma once
// Is a motion experiment what it says: units, sides, headings, counters?

#include "gap/data/experiment.h"

namespace puckloop::gap {

/// As check(): throws InputError or adds cautions.
void check_motion(Experiment& experiment);

/// m of way for a step of the left wheel, by the nominal numbers.
double metres_per_step(const Experiment& experiment);

}  // namespace puckloop::gap
