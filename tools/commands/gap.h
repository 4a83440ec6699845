#pragma once
// The subcommands of `puckloop gap`, one file each.

namespace CLI {
class App;
}

namespace puckloop::tools {

void declare_gap_import(CLI::App& gap, int& status);

}  // namespace puckloop::tools
