// puckloop-gap: what `puckloop gap` becomes. It serves nodes too: experiments on the emulator are runs.

#include "run/factory/node_process.h"
#include "tools/cli/ample_stack.h"
#include "tools/cli/file_size_limit.h"
#include "tools/cli/program.h"
#include "tools/gap/subcommands.h"

#include <array>

namespace puckloop::tools {
namespace {

int run_gap(int argc, char** argv) {
    survive_file_size_limit();
    if (const auto status = serve_as_node(argc, argv)) return *status;
    constexpr std::array<DeclareCommand, 1> kCommands{declare_gap};
    return run_program(kCommands, {argv + 1, argv + argc});
}

}  // namespace
}  // namespace puckloop::tools

int main(int argc, char** argv) {
    return puckloop::tools::with_ample_stack(puckloop::tools::run_gap, argc, argv);
}
