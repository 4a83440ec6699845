#pragma once
// A control loop that has lost its robot's answers gives up, and begins anew some time later. Its frames then
// count their periods from there: what came between is the program's doing, and no other frame shows it.

#include "gap/data/experiment.h"

#include <cstddef>

namespace puckloop::gap {

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
