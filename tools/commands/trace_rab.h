#pragma once

#include <CLI/CLI.hpp>

namespace puckloop::tools {

/// Adds `rab` to the command `trace`.
void declare_trace_rab(CLI::App& trace);

}  // namespace puckloop::tools
