#pragma once
// `puckloop gap` and its subcommands, each in a file of its own.

#include "tools/gap/emulate/stage.h"

namespace puckloop::tools {

class Command;

void declare_gap(Command& app, int& status);
void declare_gap_check(Command& gap, int& status);
void declare_gap_import(Command& gap, int& status);
void declare_gap_new(Command& gap, int& status);
void declare_gap_record(Command& gap, int& status);
void declare_gap_selftest(Command& gap, int& status);

/// The project's own firmware and recording program, as built.
gap::emulate::Tools emulation_tools();

}  // namespace puckloop::tools
