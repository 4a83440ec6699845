#pragma once
// CAN buses of a run: a node for each [[can_bus]] table, a link to each of its controllers.

#include "run/description/run_setup.h"

#include <string>

namespace puckloop::tools {

/// The modules of the node `board` that a bus is wired to.
board::CanModules can_modules(const scenarios::Scenario& scenario, const std::string& board);
void add_can_buses(RunSetup& setup);

}  // namespace puckloop::tools
