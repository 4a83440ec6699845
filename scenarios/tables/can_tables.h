#pragma once
// CAN buses: [[can_bus]].

#include "scenarios/description/scenario.h"
#include "scenarios/values/reader.h"

namespace puckloop::scenarios {

/// To be read when all robots have been.
void read_can_buses(Reader& top, Scenario& scenario);

}  // namespace puckloop::scenarios
