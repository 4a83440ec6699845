#pragma once
// A tracker that takes pictures at a rate of its own tells in each row the pose of its last picture: rows are
// late by a part of a frame that grows from row to row and falls back, a sawtooth. Errors of way are speed
// times lateness, not noise: few large ones one way, many small ones the other, which pull a fit that does
// not believe in large ones. Counters that are polled at a rate of their own make the same with the sign
// turned.

#include "gap/data/experiment.h"

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

/// Sets Run::counted_at, when the counters are read for each row, and says so as cautions: clocks that run
/// apart (gap/sync/clocks), and frames, where at least half the runs have one frame's length beyond doubt and
/// in common.
void align_times(Experiment& experiment);

}  // namespace puckloop::gap
