#pragma once
// The part of `puckloop bench` that measures range and bearing.

#include "tools/command.h"

namespace puckloop::tools {

void declare_bench_rab(CLI::App& bench, int& status);

}  // namespace puckloop::tools
