#pragma once
// What a limit of the stack (ulimit -s) does to this process.

namespace puckloop::tools {

/// Runs `program` and returns its status: where the stack is limited to less than the usual 8 MiB, in a
/// thread that has them, and threads made later have as much. The limit stays, for the programs that are
/// executed.
int with_ample_stack(int (*program)(int, char**), int argc, char** argv);

}  // namespace puckloop::tools
