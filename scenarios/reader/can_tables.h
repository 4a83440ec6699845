#pragma once
// CAN buses: [[can_bus]].

#include "scenarios/reader/reader.h"
#include "scenarios/reader/scenario.h"

namespace puckloop::scenarios {

/// To be read when all robots have been.
void read_can_buses(Reader& top, Scenario& scenario);

}  // namespace puckloop::scenarios
