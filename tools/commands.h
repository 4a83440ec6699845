#pragma once
// The list of subcommands. Add a declaration and a line here; keep both in the order of the design's command
// line.

#include "tools/cli/command.h"
#include "tools/cli/other_programs.h"

#include <array>

namespace puckloop::cosim {
class NodeHosts;
}

namespace puckloop::tools {

void declare_run(Command& app, int& status);
/// The same with nodes on these, which outlive the command; null: as it is.
void declare_run_on(Command& app, int& status, cosim::NodeHosts* hosts);
void declare_import(Command& app, int& status);
void declare_act(Command& app, int& status);
void declare_mcp(Command& app, int& status);
void declare_shell(Command& app, int& status);

// clang-format off
inline constexpr std::array kCommands{
    declare_run,
    declare_import,
    declare_other<"replay">,
    declare_act,
    declare_mcp,
    declare_other<"exec">,
    declare_other<"debug">,
    declare_other<"dap">,
    declare_shell,
    declare_other<"step">,
    declare_other<"asm">,
    declare_other<"disasm">,
    declare_other<"trace">,
    declare_other<"view">,
    declare_other<"frames">,
    declare_other<"faults">,
    declare_other<"experiment">,
    declare_other<"upload">,
    declare_other<"bench">,
    declare_other<"gap">,
};
// clang-format on

}  // namespace puckloop::tools
