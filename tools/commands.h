#pragma once
// The list of subcommands. Add a declaration and a line here; keep both in the order of the design's command
// line.

#include "tools/cli/command.h"

#include <array>

namespace puckloop::tools {

void declare_run(Command& app, int& status);
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
void declare_gap(Command& app, int& status);  ///< its line of the help
void declare_bench(Command& app, int& status);

/// Replaces this process by puckloop-gap with the same words; returns, with status 2, only where it is not
/// built.
int become_gap(char** words);

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
    declare_gap,
    declare_bench,
};
// clang-format on

}  // namespace puckloop::tools
