#pragma once
// The cells over which a free-form correction may differ: bins of every covariate, of pairs of them, of what
// a covariate was in the rows before, and of the place in the run.

#include "gap/data/experiment.h"
#include "gap/findings/findings.h"
#include "gap/stats/boosting.h"

#include <vector>

namespace puckloop::gap {

/// `rows`: run and row of each value, in chains; `starts`: 1 where a chain begins. Components are in a fixed
/// order.
std::vector<stats::Component> free_form_cells(const Experiment& experiment, const Series& rows,
                                              const std::vector<char>& starts);

}  // namespace puckloop::gap
