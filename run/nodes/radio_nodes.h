#pragma once
// The radio of a run: the modules of TAMs and coordinator, and the air between them.

#include "run/description/run_request.h"
#include "run/description/run_setup.h"

namespace puckloop::tools {

/// Modules, their links to boards and to what is plugged in, and the medium, where the scenario has any.
/// After the TAMs. Throws InputError.
void add_radio(RunSetup& setup, const RunRequest& request);

}  // namespace puckloop::tools
