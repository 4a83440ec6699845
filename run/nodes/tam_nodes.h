#pragma once
// The TAMs of a run: nodes and links.

#include "run/description/run_request.h"
#include "run/description/run_setup.h"

namespace puckloop::tools {

/// What the world's description has to know of them; before the world is described.
void describe_booths(scenarios::Scenario& scenario);

/// Board, console and link to the world of every TAM. Throws InputError.
void add_tams(RunSetup& setup, const RunRequest& request);

/// When all links are there: whether anybody is at a TAM's ports `pins` and `ir`.
void name_linked_ports(RunSetup& setup);

}  // namespace puckloop::tools
