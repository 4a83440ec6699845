// puckloop-bench: what `puckloop bench` becomes.

#include "tools/bench/bench.h"
#include "tools/cli/command_program.h"

int main(int argc, char** argv) {
    return puckloop::tools::command_program<puckloop::tools::declare_bench>(argc, argv);
}
