#pragma once
// The part of `puckloop bench` that measures range and bearing.

#include "tools/cli/command.h"

namespace puckloop::tools {

void declare_bench_rab(Command& bench, int& status);

}  // namespace puckloop::tools
