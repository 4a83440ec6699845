#pragma once
// Cells missing in columns that the models predict from. A model would take what it takes where there is no
// such column at all (0 bytes on the line, 0 rad of incidence), and the jumps to and fro would look like an
// effect.

#include "gap/data/experiment.h"

namespace puckloop::gap {

/// In each run: a column with one value only is filled with it, other covariates are drawn on between their
/// neighbours (temperature, battery, time) or held; where a truth or stimulus that varies is missing, what
/// was measured is left out (counts of events, received or whole, stay, with the run's usual value beside
/// them). A caution a column. InputError where most of a measurement would go. Motion has rules of its own
/// (gap/models).
void fill_missing(Experiment& experiment);

}  // namespace puckloop::gap
