// puckloop: a table of subcommands. Some are programs of their own (tools/cli/other_programs.h).

#include "run/factory/node_process.h"
#include "run/plan/linux_arguments.h"
#include "tools/cli/ample_stack.h"
#include "tools/cli/file_size_limit.h"
#include "tools/cli/other_programs.h"
#include "tools/cli/program.h"
#include "tools/commands.h"
#include "tools/guide/guide.h"

#include <array>
#include <vector>

namespace puckloop::tools {
namespace {

// clang-format off
constexpr std::array kFirstSteps{declare_new, declare_list, declare_check, declare_images, declare_schema};
constexpr std::array kHelp{declare_test, declare_help, declare_version};
constexpr std::array kHeadings{
    Heading{"new", "First steps"}, Heading{"list", "First steps"}, Heading{"check", "First steps"},
    Heading{"images", "First steps"}, Heading{"schema", "First steps"},
    Heading{"run", "Run"}, Heading{"replay", "Run"}, Heading{"act", "Run"}, Heading{"shell", "Run"}, Heading{"mcp", "Run"},
    Heading{"exec", "Run"}, Heading{"import", "Run"},
    Heading{"debug", "Chips and images"}, Heading{"dap", "Chips and images"},
    Heading{"step", "Chips and images"}, Heading{"asm", "Chips and images"}, Heading{"disasm", "Chips and images"},
    Heading{"upload", "Chips and images"},
    Heading{"view", "Look at what was recorded"}, Heading{"trace", "Look at what was recorded"}, Heading{"frames", "Look at what was recorded"},
    Heading{"faults", "Faults and measurements"}, Heading{"experiment", "Faults and measurements"}, Heading{"gap", "Faults and measurements"},
    Heading{"bench", "Faults and measurements"}, Heading{"test", "Faults and measurements"},
    Heading{"help", "Help"}, Heading{"version", "Help"}};
// clang-format on

std::vector<DeclareCommand> all_commands() {
    std::vector<DeclareCommand> all(kFirstSteps.begin(), kFirstSteps.end());
    all.insert(all.end(), kCommands.begin(), kCommands.end());
    all.insert(all.end(), kHelp.begin(), kHelp.end());
    return all;
}

int run(int argc, char** argv) {
    survive_file_size_limit();
    if (const auto status = serve_as_node(argc, argv)) return *status;
    if (const auto status = become_other(argc, argv)) return *status;
    return run_program(all_commands(), pack_linux_arguments({argv + 1, argv + argc}), kHeadings);
}

}  // namespace
}  // namespace puckloop::tools

int main(int argc, char** argv) {
    return puckloop::tools::with_ample_stack(puckloop::tools::run, argc, argv);
}
