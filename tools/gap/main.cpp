// puckloop-gap: what `puckloop gap` becomes.

#include "tools/cli/command_program.h"
#include "tools/gap/subcommands.h"

int main(int argc, char** argv) {
    return puckloop::tools::command_program<puckloop::tools::declare_gap>(argc, argv);
}
