#include "tests/time_bounds/drawn_run.h"

#include "cosim/conductor.h"
#include "cosim/resume/run_snapshot.h"
#include "run/factory/node_factory.h"
#include "run/run_scenario.h"
#include "run/setup.h"
#include "scenarios/reader/read_scenario.h"

#include <algorithm>

namespace puckloop::tests {

namespace {

/// Into a folder of its own: boards and programs leave files.
cosim::Outcome conduct(tools::RunRequest request, const std::filesystem::path& out,
                       cosim::RunOptions options) {
    request.out = out;
    std::filesystem::create_directories(out);
    const tools::RunSetup setup = tools::set_up(request);
    tools::make_work_folders(setup);
    options.duration = cosim::from_seconds(*request.duration);
    options.in_process = request.in_process;
    options.seed = setup.scenario.seed;
    options.node_command = {PUCKLOOP_PROGRAM};
    cosim::Conductor conductor(tools::node_specs(setup), setup.links, setup.scenario.faults, options,
                               tools::make_described);
    return conductor.run();
}

Conducted result_of(const cosim::Outcome& outcome) {
    return {outcome.reason == cosim::EndReason::Failed, outcome.text, outcome.trace_sha256};
}

}  // namespace

Conducted conduct(const Workbench& bench, const std::filesystem::path& scenario, double seconds,
                  const std::string& name, const Way& way) {
    tools::RunRequest request;
    request.scenario = scenario;
    request.duration = seconds;
    request.in_process = !way.process_per_node;
    cosim::RunOptions options;
    options.threads = way.threads;
    options.windows = way.windows;
    if (way.chop != 0) options.chop_seed = way.chop;
    std::optional<cosim::RunSnapshot> snapshot;
    if (way.from) {
        options.save_at = {*way.from};
        options.save = [&](cosim::RunSnapshot& taken) { snapshot = taken; };
        const Conducted saving = result_of(conduct(request, bench.out(name + "-saving"), options));
        options.save_at.clear();
        options.save = nullptr;
        // A program may have ended the run before.
        if (saving.failed || !snapshot) return saving;
        options.from = &*snapshot;
    }
    return result_of(conduct(request, bench.out(name), options));
}

std::vector<cosim::Time> begins_of_faults(const std::filesystem::path& scenario) {
    std::vector<cosim::Time> begins;
    for (const cosim::FaultSpec& fault : scenarios::read_scenario(scenario).faults)
        begins.push_back(fault.begin);
    return begins;
}

}  // namespace puckloop::tests
