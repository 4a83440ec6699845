#pragma once
// From a scenario to the nodes and links of a run.

#include "run/description/run_request.h"
#include "run/description/run_setup.h"

namespace puckloop::tools {

/// Reads the scenario, applies the request's changes and plans nodes and links. Throws InputError for
/// everything that can be seen before the run: options, files, images that do not fit.
RunSetup set_up(const RunRequest& request);

}  // namespace puckloop::tools
