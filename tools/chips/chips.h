#pragma once
// The commands of puckloop-chips: a chip or a board without a run, and its images.

#include "tools/cli/command.h"

namespace puckloop::tools {

void declare_exec(Command& app, int& status);
void declare_debug(Command& app, int& status);
void declare_dap(Command& app, int& status);
void declare_step(Command& app, int& status);
void declare_asm(Command& app, int& status);
void declare_disasm(Command& app, int& status);
void declare_upload(Command& app, int& status);

}  // namespace puckloop::tools
