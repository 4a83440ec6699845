#pragma once
// The run loop, for Core alone.

#include "emu/avr/core/core.h"

namespace puckloop::avr {

/// See Core::run().
Core::Outcome run_until(Machine& m, Cycle until);

}  // namespace puckloop::avr
