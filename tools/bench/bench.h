#pragma once
// The command line of `puckloop bench`.

#include "tools/cli/command.h"

namespace puckloop::tools {

void declare_bench(Command& app, int& status);

}  // namespace puckloop::tools
