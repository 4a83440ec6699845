#pragma once
// One sensor record out of several that came within a control step: each value is the median of theirs, so
// that one garbled record, which has no check to show it, is outvoted.

#include "protocols/serial/epuck_serial.h"

#include <span>

namespace puckloop::control {

/// The newest record with its proximity, light and battery values replaced by the medians of all; of an even
/// number the lower one of the middle two. What concerns a word (IRcom, range and bearing) stays the
/// newest's. `records`, oldest first, is not empty.
protocols::EpuckSensors median_of(std::span<const protocols::EpuckSensors> records);

}  // namespace puckloop::control
