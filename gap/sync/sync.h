#pragma once
// When rows were taken, by clocks of their own: found and put right, or counted anew, before anything is
// fitted.

#include "gap/data/experiment.h"

#include <cstddef>
#include <vector>

namespace puckloop::gap {

/// The sawtooth of a run's lateness: late(t) = period (frac(beat t + phase) - 1/2), t in s of the run's rows.
struct FrameBeat {
    double period =
        0.0;            ///< s between frames; negative where it falls slowly: by aliasing, or of the counters
    double beat = 0.0;  ///< Hz, up to half the rate of rows
    double phase = 0.0;     ///< of a turn
    double evidence = 0.0;  ///< by how much the deviance falls
    bool clear = false;     ///< beyond doubt, better than any sinusoid, and the only one of its size
};

/// Of a motion experiment with step counters in every run, a beat each run. Empty when the runs cannot say;
/// a run whose rows are not evenly spaced (rows may be missing) has none.
std::vector<FrameBeat> frame_beats(const Experiment& experiment);

/// Of a motion experiment with step counters in every run. Where lateness drifts inside runs beyond doubt,
/// sets Run::counted_at (or corrects it) and adds a caution. Lateness is found by setting the tracker's
/// changes of way and heading against the counters'; scale, axle, mismatch and a drift of heading are fitted
/// along, so that none of them is taken for it. A lateness that is about the same in all runs is left to the
/// effect of that name.
void align_clocks(Experiment& experiment);

/// Sets Run::counted_at, when the counters are read for each row, and says so as cautions: clocks that run
/// apart, and frames, where at least half the runs have one frame's length beyond doubt and in common.
void align_times(Experiment& experiment);

/// A frame's number (the row's where none is given) and the period that it counts by, s (0.1 where none is
/// stated).
struct FrameCount {
    double number, period;
};
FrameCount frame_count(const Run& run, std::size_t row);

/// Of timing without the robot's own clock: sets Run::begun_anew to the rows that come later than the frames
/// broken or missing before them account for, by half a period or more, and gives a caution.
void find_pauses(Experiment& experiment);

}  // namespace puckloop::gap
