// puckloop: a table of subcommands. `gap` is a program of its own (tools/gap).

#include "run/factory/node_process.h"
#include "run/plan/linux_arguments.h"
#include "tools/cli/program.h"
#include "tools/commands.h"

#include <string_view>

int main(int argc, char** argv) {
    using namespace puckloop::tools;
    if (const auto status = serve_as_node(argc, argv)) return *status;
    if (argc > 1 && std::string_view(argv[1]) == "gap") return become_gap(argv);
    return run_program(kCommands, pack_linux_arguments({argv + 1, argv + argc}));
}
