#pragma once
// The commands of puckloop-records: what a run recorded, and frames.

#include "tools/cli/command.h"

namespace puckloop::tools {

void declare_replay(Command& app, int& status);
void declare_trace(Command& app, int& status);
void declare_frames(Command& app, int& status);

}  // namespace puckloop::tools
