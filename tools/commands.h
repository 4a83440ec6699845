#pragma once
// The list of subcommands. Add a declaration and a line here; keep both in the order of the design's command
// line.

#include "tools/command.h"

#include <array>

namespace puckloop::tools {

inline constexpr std::array<DeclareCommand, 0> kCommands{};

}  // namespace puckloop::tools
