#pragma once
// Rows of two robots in one file, where no column `unit` says so.

#include "gap/data/experiment.h"

namespace puckloop::gap {

/// Motion: InputError if a run's pose jumps to and fro between two paths. Timing: InputError if `seq` does
/// not count on; a caution where frames come twice as often as `nominal_period` says. Proximity, ground,
/// microphone: a caution if what was measured at one placement falls into two levels, to and fro. Not seen:
/// two robots of which each has runs of its own, readings whose placements are never repeated, and other
/// kinds.
void check_mixed(Experiment& experiment);

}  // namespace puckloop::gap
