#pragma once
// CAN buses: [[can_bus]].

#include "scenarios/reader.h"
#include "scenarios/scenario.h"

namespace puckloop::scenarios {

/// To be read when all robots have been.
void read_can_buses(Reader& top, Scenario& scenario);

}  // namespace puckloop::scenarios
