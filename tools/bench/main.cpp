// puckloop-bench: what `puckloop bench` becomes. It serves nodes too: what it measures are runs.

#include "run/factory/node_process.h"
#include "tools/bench/bench.h"
#include "tools/cli/ample_stack.h"
#include "tools/cli/file_size_limit.h"
#include "tools/cli/program.h"

#include <array>

namespace puckloop::tools {
namespace {

int run_bench_program(int argc, char** argv) {
    survive_file_size_limit();
    if (const auto status = serve_as_node(argc, argv)) return *status;
    constexpr std::array<DeclareCommand, 1> kBench{declare_bench};
    return run_program(kBench, {argv + 1, argv + argc});
}

}  // namespace
}  // namespace puckloop::tools

int main(int argc, char** argv) {
    return puckloop::tools::with_ample_stack(puckloop::tools::run_bench_program, argc, argv);
}
