#pragma once
// Is what [nominal] says of a robot possible?

#include "gap/data/experiment.h"

namespace puckloop::gap {

/// InputError, naming the file and the number, for what no robot can have; a caution for what is far from
/// anything that the simulator's robot can have: mostly a number in another unit.
void check_nominal(Experiment& experiment);

}  // namespace puckloop::gap
