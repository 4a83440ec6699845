#pragma once
// Load and tilt of the table, which a laboratory knows: noted beside what is measured, and set up again from
// what was noted.

#include "gap/data/experiment.h"
#include "gap/data/written.h"
#include "selftest/emulate/stage.h"

#include <vector>

namespace puckloop::gap::emulate {

/// The columns load_kg and incline_rad of a run.
void note_surroundings(const Act& act, const std::vector<Row>& rows, WrittenRun& run);

/// From the same columns, if they are there; the least tilt that they tell, as far as the simulator takes it.
void restore_surroundings(const Run& run, Act& act);

}  // namespace puckloop::gap::emulate
