// puckloop-mpi: `puckloop run` on the ranks of an MPI job, on one machine or several.

#include "cosim/remote/mpi/mpi_hosts.h"
#include "cosim/remote/mpi/rank_server.h"
#include "run/factory/node_factory.h"
#include "run/factory/node_process.h"
#include "run/plan/linux_arguments.h"
#include "tools/cli/ample_stack.h"
#include "tools/cli/file_size_limit.h"
#include "tools/cli/program.h"
#include "tools/commands.h"
#include "tools/mpi/scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <string_view>

namespace puckloop::tools {
namespace {

// What a rank that computes has still in hand when the run is over.
constexpr std::chrono::seconds kEndPatience{10};

/// There is one job in a process.
cosim::MpiHosts* g_hosts = nullptr;

void declare_run_on_hosts(Command& app, int& status) {
    declare_run_on(app, status, g_hosts);
}

void declare_scale_of_hosts(Command& app, int& status) {
    declare_scale(app, status, *g_hosts);
}

/// Ctrl-C is rank 0's to answer: it asks the nodes to wind up. Programs of boards would inherit it if signals
/// were ignored here.
void leave_signals_to_conductor() {
    for (const int signal : {SIGINT, SIGTERM})
        std::signal(signal, [](int) {});
}

int serve(int argc, char** argv) {
    leave_signals_to_conductor();
    const auto interprets = [](std::string_view word) { return word == "--no-translate"; };
    if (std::any_of(argv + 1, argv + argc, interprets)) interpret_from_here(false);
    cosim::serve_rank(make_described);
    return 0;
}

int run(int argc, char** argv) {
    survive_file_size_limit();
    cosim::MessagePassing job(argc, argv);
    if (job.rank() != 0) return serve(argc, argv);
    cosim::MpiHosts hosts(job);
    g_hosts = &hosts;
    constexpr std::array kCommandsHere{declare_run_on_hosts, declare_scale_of_hosts};
    const int status =
        run_program(kCommandsHere, pack_linux_arguments({argv + 1, argv + argc}), {}, "puckloop-mpi");
    if (const cosim::MpiTraffic& traffic = hosts.traffic(); traffic.messages > 0)
        fmt::print(stderr, "{} ranks: {} messages, {:.1f} MB, {:.2f} s waited\n", job.ranks(),
                   traffic.messages, 1e-6 * static_cast<double>(traffic.bytes), traffic.waited_s);
    if (!hosts.end(kEndPatience)) job.abort(std::max(status, 1));
    return status;
}

}  // namespace
}  // namespace puckloop::tools

int main(int argc, char** argv) {
    return puckloop::tools::with_ample_stack(puckloop::tools::run, argc, argv);
}
