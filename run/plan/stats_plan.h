#pragma once
// Which boards of a run are profiled, and what the terminal shows of it.

#include "cosim/conductor.h"
#include "run/description/run_request.h"
#include "run/description/run_setup.h"

#include <string>

namespace puckloop::tools {

/// Has every board that `request` names profiled; they begin at power-up. Throws InputError: no such board,
/// or a run in which they cannot.
void plan_stats(RunSetup& setup, const RunRequest& request);

/// Of each of them its stack and its reads of RAM that nothing had written; each line begins with a newline.
std::string stats_summary(const cosim::Outcome& outcome);

}  // namespace puckloop::tools
