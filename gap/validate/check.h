#pragma once
// Is this data what it says it is? Looked at before anything is fitted.

#include "gap/data/experiment.h"

namespace puckloop::gap {

/// Throws InputError for what cannot be used; appends to `cautions` what can be used with care. May drop
/// rows that no analysis can use (all truth missing) and says so.
/// Where `problems` are gathered, every check is made; those that need sound columns only where all are.
void check(Experiment& experiment, Problems* problems = nullptr);

}  // namespace puckloop::gap
