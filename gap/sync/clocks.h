#pragma once
// Do tracker and counters tell the same time? Two loggers that were started by hand, or whose clocks differ
// by a few parts in a thousand, make an error of heading that is turn rate times lateness: it looks like
// slip.

#include "gap/data/experiment.h"

namespace puckloop::gap {

/// Of a motion experiment with step counters in every run. Where lateness drifts inside runs beyond doubt,
/// sets Run::counted_at (or corrects it) and adds a caution. Lateness is found by setting the tracker's
/// changes of way and heading against the counters'; scale, axle, mismatch and a drift of heading are fitted
/// along, so that none of them is taken for it. A lateness that is about the same in all runs is left to the
/// effect of that name.
void align_clocks(Experiment& experiment);

}  // namespace puckloop::gap
