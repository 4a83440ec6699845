#pragma once
// What a run does with states of its boards: --save-state, --from-state, and boots from the cache.

#include "cosim/conductor.h"
#include "run/description/run_request.h"
#include "run/description/run_setup.h"

#include <string>

namespace puckloop::tools {

/// Adds to the boards' descriptions where their states come from and go to. Throws InputError for files that
/// cannot be read or written, and for states of other firmware or chips.
void plan_states(RunSetup& setup, const RunRequest& request);

/// After the run: one file of the states that the boards saved, if that was asked for. A run that ended too
/// early for it has failed; its file stays as it was.
void collect_states(const RunSetup& setup, cosim::Outcome& outcome);

/// Lines for the terminal: which boots were skipped, where states came from and went to.
std::string states_summary(const RunSetup& setup, const cosim::Outcome& outcome);

}  // namespace puckloop::tools
