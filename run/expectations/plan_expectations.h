#pragma once
// What the scenario expects, before the run.

#include "run/description/run_request.h"
#include "run/description/run_setup.h"

namespace puckloop::tools {

/// Has boards watched whose values are expected; they begin at power-up, without a kept boot. Throws
/// InputError where a table names a node, link, robot or protocol that there is not, or with `request`'s
/// saved states.
void plan_expectations(RunSetup& setup, const RunRequest& request);

}  // namespace puckloop::tools
