#pragma once
// Bluetooth of a run: one node with the modules of all robots, the computers linked with them, and the air.

#include "run/description/run_request.h"
#include "run/description/run_setup.h"

namespace puckloop::tools {

/// The node and its links, where any robot has a module. Throws InputError.
void add_bluetooth(RunSetup& setup, const RunRequest& request);

}  // namespace puckloop::tools
