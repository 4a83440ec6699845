#pragma once
// Headings for the many options of `run` and `exec` in their help.

#include <CLI/CLI.hpp>

namespace puckloop::tools {

/// Options of a command that are declared from a certain one on are listed under its heading. Hidden ones
/// stay hidden, and those of -v and --log-level have one of their own everywhere.
void set_sections(CLI::App& command);

}  // namespace puckloop::tools
