#pragma once
// Commands that help to begin: what there is, and what goes with it.

#include "tools/cli/command.h"

namespace puckloop::tools {

void declare_new(Command& app, int& status);
void declare_list(Command& app, int& status);
void declare_check(Command& app, int& status);
void declare_images(Command& app, int& status);
void declare_schema(Command& app, int& status);
void declare_help(Command& app, int& status);
void declare_version(Command& app, int& status);
void declare_test(Command& app, int& status);  ///< its line of the help

}  // namespace puckloop::tools
