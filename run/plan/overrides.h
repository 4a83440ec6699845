#pragma once
// What the command line changes in a scenario.

#include "run/description/run_request.h"
#include "scenarios/reader/read_scenario.h"

namespace puckloop::tools {

/// What the command line decides before the scenario is read.
scenarios::Settings settings_of(const RunRequest& request);

/// Firmware, Linux program, duration, seed, overlay, faults. Throws InputError for a board that is not there,
/// a file that cannot be read.
void apply(const RunRequest& request, scenarios::Scenario& scenario);

}  // namespace puckloop::tools
