#pragma once
// Resets of boards by their supply, for a run's summary. They are no warnings: the board does what it should.

#include "cosim/conductor.h"

#include <string>

namespace puckloop::tools {

/// A line for each board that its supply reset after power-up, each beginning with a line break: cause, how
/// often, and the first one's instant and place.
std::string supply_resets_summary(const cosim::Outcome& outcome);

}  // namespace puckloop::tools
