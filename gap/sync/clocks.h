#pragma once
// Do tracker and counters tell the same time? Two loggers that were started by hand, or whose clocks differ
// by a few parts in a thousand, make an error of heading that is turn rate times lateness: it looks like
// slip.

#include "gap/data/experiment.h"

namespace puckloop::gap {

/// How the clock of a run's counters stands to its tracker's.
struct ClockError {
    double late = 0.0;   ///< s by which the tracker's rows come after the counters', in the middle of the run
    double drift = 0.0;  ///< s by which `late` grows from the run's first row to its last
    double late_sd = 0.0, drift_sd = 0.0;
};

/// Of a motion experiment with step counters in every run: a clock error each run, found by setting the
/// tracker's changes of way and heading against the counters'. Scale, axle, mismatch and a drift of heading
/// are fitted along, so that none of them is taken for lateness. Empty when the runs cannot say.
std::vector<ClockError> clock_errors(const Experiment& experiment);

/// Where lateness drifts inside runs beyond doubt, sets Run::counted_at (or corrects it) and says so as a
/// caution. A lateness that is about the same in all runs is left to the effect of that name.
void align_clocks(Experiment& experiment);

}  // namespace puckloop::gap
