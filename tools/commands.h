#pragma once
// The list of subcommands. Add a declaration and a line here; keep both in the order of the design's command
// line.

#include "tools/cli/command.h"

#include <array>
#include <optional>

namespace puckloop::cosim {
class NodeHosts;
}

namespace puckloop::tools {

void declare_run(Command& app, int& status);
/// The same with nodes on these, which outlive the command; null: as it is.
void declare_run_on(Command& app, int& status, cosim::NodeHosts* hosts);
void declare_import(Command& app, int& status);
void declare_replay(Command& app, int& status);
void declare_act(Command& app, int& status);
void declare_mcp(Command& app, int& status);
void declare_exec(Command& app, int& status);
void declare_debug(Command& app, int& status);
void declare_dap(Command& app, int& status);
void declare_shell(Command& app, int& status);
void declare_step(Command& app, int& status);
void declare_asm(Command& app, int& status);
void declare_disasm(Command& app, int& status);
void declare_trace(Command& app, int& status);
void declare_view(Command& app, int& status);
void declare_frames(Command& app, int& status);
void declare_faults(Command& app, int& status);
void declare_experiment(Command& app, int& status);
void declare_upload(Command& app, int& status);
/// The lines in the help of what become_other() becomes.
void declare_other_programs(Command& app, int& status);

/// `bench` and `gap`: replaces this process by puckloop-bench or puckloop-gap with the same words. Returns 2,
/// an exit status, where that is not built, and nothing for other commands.
std::optional<int> become_other(int argc, char** argv);

// clang-format off
inline constexpr std::array kCommands{
    declare_run,
    declare_import,
    declare_replay,
    declare_act,
    declare_mcp,
    declare_exec,
    declare_debug,
    declare_dap,
    declare_shell,
    declare_step,
    declare_asm,
    declare_disasm,
    declare_trace,
    declare_view,
    declare_frames,
    declare_faults,
    declare_experiment,
    declare_upload,
    declare_other_programs,
};
// clang-format on

}  // namespace puckloop::tools
