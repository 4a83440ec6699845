#pragma once
// A tracker that takes pictures at a rate of its own tells in each row the pose of its last picture: rows are
// late by a part of a frame that grows from row to row and falls back, a sawtooth. Errors of way are speed
// times lateness, not noise: few large ones one way, many small ones the other, which pull a fit that does
// not believe in large ones.

#include "gap/experiment.h"

#include <vector>

namespace puckloop::gap {

/// The sawtooth of a run's lateness: late(t) = period (frac(beat t + phase) - 1/2), t in s of the tracker's
/// rows.
struct FrameBeat {
    double period =
        0.0;  ///< s between frames; negative where rows alias the beat, so that it seems to run backwards
    double beat = 0.0;   ///< Hz, up to half the rate of rows
    double phase = 0.0;  ///< of a turn
    double gain = 0.0;   ///< by how much the deviance falls
    bool clear = false;  ///< beyond doubt, and better than any sinusoid (a wheel that is not round)
};

/// Of a motion experiment with step counters in every run, a beat each run; empty when the runs cannot say.
std::vector<FrameBeat> frame_beats(const Experiment& experiment);

/// Where at least half the runs have one frame's length beyond doubt and in common, sets Run::counted_at (or
/// corrects it) and says so as a caution. To be called after align_clocks().
void align_frames(Experiment& experiment);

}  // namespace puckloop::gap
