#pragma once
// Rows and runs that are copies of others: pasted, not measured.

#include "gap/data/experiment.h"

namespace puckloop::gap {

/// Finds copies among the runs' observables (their truth, where a kind has no observable column), takes the
/// later one out and says so as a caution. In kinds that are time series (motion, accelerometer, timing) only
/// whole runs are taken out: two runs may well begin alike.
void drop_copies(Experiment& experiment);

}  // namespace puckloop::gap
