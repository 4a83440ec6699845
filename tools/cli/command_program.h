#pragma once
// A program that has some commands of puckloop's, which puckloop becomes. It serves nodes too: what it does
// are runs.

#include "run/factory/node_process.h"
#include "tools/cli/ample_stack.h"
#include "tools/cli/file_size_limit.h"
#include "tools/cli/program.h"

#include <array>

namespace puckloop::tools {

/// Its main(): the exit status.
template <DeclareCommand... kDeclare>
int command_program(int argc, char** argv) {
    const auto run = [](int count, char** words) {
        survive_file_size_limit();
        if (const auto status = serve_as_node(count, words)) return *status;
        constexpr std::array kCommands{kDeclare...};
        return run_program(kCommands, {words + 1, words + count});
    };
    return with_ample_stack(run, argc, argv);
}

}  // namespace puckloop::tools
