#pragma once
// `puckloop bench density`.

#include "tools/cli/command.h"

namespace puckloop::tools {

void declare_bench_density(Command& bench, int& status);

}  // namespace puckloop::tools
