#pragma once
// What the command line changes in a scenario.

#include "run/description/run_request.h"
#include "scenarios/reader/scenario.h"

namespace puckloop::tools {

/// Firmware, Linux program, duration, seed, overlay, faults. Throws InputError for a board that is not there,
/// a file that cannot be read.
void apply(const RunRequest& request, scenarios::Scenario& scenario);

}  // namespace puckloop::tools
