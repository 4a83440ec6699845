#pragma once
// The part of `puckloop bench` that repeats published experiments with sound.

#include "tools/cli/command.h"

namespace puckloop::tools {

void declare_bench_sound(Command& bench, int& status);

}  // namespace puckloop::tools
