#pragma once
// The command of puckloop-view.

#include "tools/cli/command.h"

namespace puckloop::tools {

void declare_view(Command& app, int& status);

}  // namespace puckloop::tools
