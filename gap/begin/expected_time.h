#pragma once
// How long an analysis takes: an estimate beforehand, and what is left of it while it goes on.

#include "gap/data/experiment.h"

namespace puckloop::gap {

/// s of wall time on an idle machine, from the measured cost of a kind's rows (docs/gap.md has how right).
struct ExpectedTime {
    double nothing = 0.0;    ///< where nothing is wrong
    double something = 0.0;  ///< where causes and what is left are to be looked at
};
ExpectedTime expected_time(const Experiment& experiment, unsigned threads);

/// s left at a share (0..1) of the work after `elapsed` s: the estimate first, then more and more what the
/// work took.
double seconds_left(double expected, double elapsed, double share);

/// "about 4 s", "about 2 min".
std::string rough_time(double seconds);

}  // namespace puckloop::gap
