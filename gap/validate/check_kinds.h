#pragma once
// Checks that need to know what a kind of experiment is: swapped columns, wrong units that stay plausible.

#include "gap/data/experiment.h"

namespace puckloop::gap {

/// As check(): throws InputError or adds cautions.
void check_kind(Experiment& experiment);

}  // namespace puckloop::gap
