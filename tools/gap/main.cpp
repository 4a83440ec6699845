// puckloop-gap: what `puckloop gap` becomes. It serves nodes too: experiments on the emulator are runs.

#include "tools/cli/program.h"
#include "tools/gap/subcommands.h"

#include <array>

int main(int argc, char** argv) {
    using namespace puckloop::tools;
    constexpr std::array<DeclareCommand, 2> kCommands{declare_gap, declare_node};
    return run_program(kCommands, {argv + 1, argv + argc});
}
