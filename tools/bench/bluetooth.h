#pragma once
// The part of `puckloop bench` that draws Bluetooth exchanges.

#include "tools/cli/command.h"

namespace puckloop::tools {

void declare_bench_bluetooth(Command& bench, int& status);

}  // namespace puckloop::tools
