#pragma once
// The commands of puckloop-campaigns: many runs, with faults or of a swarm's programs.

#include "tools/cli/command.h"

namespace puckloop::tools {

void declare_faults(Command& app, int& status);
void declare_experiment(Command& app, int& status);

}  // namespace puckloop::tools
