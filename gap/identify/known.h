#pragma once
// Whether the data know a cause's numbers at all: better than they were believed before, and where they can
// be.

#include "gap/identify/counts.h"

namespace puckloop::gap {

/// Causes that move means by a number that is known no better than its prior, or that lies beyond what is
/// possible for this robot.
NotIdentified not_known(const Study& study, const Fit& fit);

}  // namespace puckloop::gap
