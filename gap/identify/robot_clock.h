#pragma once
// Whether a robot's clock, as it was noted, says when frames were made: where arrivals do not follow what it
// scatters by, the scatter is the clock's own, and what seems to round arrivals is their evenness.

#include "gap/identify/counts.h"

namespace puckloop::gap {

/// By how much arrivals follow what the robot's clock scatters by from frame to frame: 1 where it is right,
/// nothing where it errs. Not known (deviation infinite) where it hardly scatters beyond its rounding.
struct Following {
    double slope = 1.0, sd = 0.0;
    double scatter = 0.0;  ///< s, of the clock from frame to frame
    bool errs() const;
};
Following following(const Experiment& experiment);

/// Causes of a fit that rest on when single frames were made, where the clock that says so errs.
NotIdentified not_by_clock(const Study& study, const Fit& fit);

}  // namespace puckloop::gap
