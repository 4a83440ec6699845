#pragma once
// Resets of boards by their supply, for a run's summary. They are no warnings: the board does what it should.

#include "cosim/conductor.h"

#include <string>

namespace puckloop::tools {

/// A line for each board and cause of a reset by its supply after power-up, each beginning with a line break:
/// how often, and the first one's instant and place. Chips keep their first 1000 resets of all causes: of one
/// that had more the number is a lower bound. Behind ten lines one with the number of the others.
std::string supply_resets_summary(const cosim::Outcome& outcome);

}  // namespace puckloop::tools
