#pragma once
// The run loop, for Core alone.

#include "emu/dspic/core/core.h"

namespace puckloop::dspic {

/// See Core::run().
Core::Outcome run_until(Machine& m, Cycle until);

}  // namespace puckloop::dspic
