#pragma once
// How long an analysis takes: an estimate beforehand, and what is left of it while it goes on.

#include "gap/data/experiment.h"

namespace puckloop::gap {

/// s of wall time, right within a factor of three or so: from the measured cost of a kind's rows
/// (docs/gap.md).
double expected_seconds(const Experiment& experiment, unsigned threads);

/// s left at a share (0..1) of the work after `elapsed` s: the estimate first, then more and more what the
/// work took.
double seconds_left(double expected, double elapsed, double share);

/// "about 4 s", "about 2 min".
std::string rough_time(double seconds);

}  // namespace puckloop::gap
