#pragma once
// `puckloop gap` and its subcommands, each in a file of its own.

#include "gap/emulate/stage.h"

namespace CLI {
class App;
}

namespace puckloop::tools {

void declare_gap(CLI::App& app, int& status);
void declare_gap_import(CLI::App& gap, int& status);
void declare_gap_record(CLI::App& gap, int& status);
void declare_gap_selftest(CLI::App& gap, int& status);

void declare_node(CLI::App& app, int& status);

/// The project's own firmware and recording program, as built.
gap::emulate::Tools emulation_tools();

}  // namespace puckloop::tools
