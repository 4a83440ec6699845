#pragma once
// The part of `puckloop bench` that repeats a published experiment with teams that talk by WiFi.

#include "tools/cli/command.h"

namespace puckloop::tools {

void declare_bench_network(Command& bench, int& status);

}  // namespace puckloop::tools
