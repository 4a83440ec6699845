#pragma once
// The list of subcommands. Add a declaration and a line here; keep both in the order of the design's command
// line.

#include "tools/command.h"

#include <array>

namespace puckloop::tools {

void declare_trace(CLI::App& app, int& status);

inline constexpr std::array kCommands{
    declare_trace,
};

}  // namespace puckloop::tools
