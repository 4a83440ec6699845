#pragma once
// Faults that are drawn from the table of all kinds: whatever a scenario's links and nodes can have.

#include "scenarios/description/scenario.h"
#include "tests/time_bounds/draw.h"

#include <string>

namespace puckloop::tests {

/// Some [[fault]] tables for places of the scenario, every second one on a board or program. Each begins
/// before `end`, s; what resets or cuts the supply is frequent.
std::string drawn_faults(Draw& draw, const scenarios::Scenario& scenario, double end);

}  // namespace puckloop::tests
