#include "tools/run/run_scenario.h"

#include "base/error.h"
#include "cosim/trace_csv.h"
#include "physics/trajectory_svg.h"
#include "tools/run/node_factory.h"

namespace puckloop::tools {

cosim::Outcome run_scenario(const RunSetup& setup, const RunRequest& request,
                            const std::function<void(const cosim::Progress&)>& progress,
                            const volatile std::sig_atomic_t* interrupted) {
    std::error_code error;
    std::filesystem::create_directories(setup.out, error);
    if (error) throw InputError(setup.out.string(), "", "cannot be made a folder: " + error.message());

    cosim::RunOptions options;
    if (setup.scenario.duration) options.duration = cosim::from_seconds(*setup.scenario.duration);
    options.in_process = request.in_process;
    options.realtime = request.realtime;
    options.seed = setup.scenario.seed;
    options.stall_seconds = request.stall_seconds;
    options.interrupted = interrupted;
    options.progress = progress;
    cosim::Conductor conductor(setup.nodes, setup.links, setup.scenario.faults, options, make_node);
    cosim::TraceCsvSink trace((setup.out / "trace.csv").string());
    conductor.add_sink(trace);
    cosim::Outcome outcome = conductor.run();
    try {
        physics::write_trajectory_svg(setup.scenario.world, setup.out);
    } catch (const RunError& failure) {  // a run that failed keeps its own cause, such as a full disk
        if (outcome.success) throw;
        outcome.warnings.emplace_back(failure.what());
    }
    return outcome;
}

}  // namespace puckloop::tools
