#include "tools/mpi/scale.h"

#include "base/error.h"
#include "base/files/shipped_files.h"
#include "benchmark/scenarios/lab_scenario.h"
#include "cosim/interrupt.h"
#include "run/run_scenario.h"
#include "run/setup.h"
#include "tools/cli/check.h"
#include "tools/cli/time_check.h"
#include "tools/mpi/host_model.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

namespace puckloop::tools {

namespace {

constexpr int kFew = 5, kMany = 20;
constexpr double kShortest = 0.2, kLongest = 60.0;  // s
// There and back, s: within a machine as measured, and what is usual between two.
constexpr double kInfiniband = 3e-6, kEthernet = 30e-6;

struct ScaleOptions {
    double duration = 0.5;  ///< s, of each run
    double cores = 16;
    std::filesystem::path out = "out/scale";
};

HostCost measure(cosim::MpiHosts& hosts, const ScaleOptions& options, int robots) {
    const std::filesystem::path folder = options.out / fmt::format("{}_robots", robots);
    std::filesystem::create_directories(folder);
    RunRequest request;
    request.scenario = write_lab_scenario(
        folder,
        {robots, shipped_file("firmware/epuck/epuck.hex"), shipped_file("firmware/rab/rab.hex"), {}, 0.1});
    request.out = folder / "run";
    request.duration = options.duration;
    request.hosts = &hosts;
    const cosim::MpiTraffic before = hosts.traffic();
    const double worked_before = hosts.worked_s();
    const RunSetup setup = set_up(request);
    const cosim::InterruptGuard interrupt;
    const cosim::Outcome outcome = run_scenario(setup, request, {}, &interrupt);
    if (!outcome.success) throw RunError(outcome.text);
    const cosim::MpiTraffic& after = hosts.traffic();
    const double simulated = cosim::to_seconds(outcome.simulated);
    const HostCost cost{static_cast<double>(robots),
                        (outcome.wall_s - (after.waited_s - before.waited_s)) / simulated,
                        (hosts.worked_s() - worked_before) / simulated,
                        static_cast<double>(after.waits - before.waits) / simulated};
    fmt::print("{} robots, a simulated second: conductor {:.2f} s, boards and programs {:.2f} s, {:.0f} k "
               "messages, {:.0f} k waits\n",
               robots, cost.conductor_s, cost.boards_s,
               1e-3 * static_cast<double>(after.messages - before.messages) / simulated, 1e-3 * cost.waits);
    return cost;
}

int scale(cosim::MpiHosts& hosts, const ScaleOptions& options) {
    if (hosts.count() == 0)
        throw InputError("", "scale", "there is one rank, and no message to measure", "mpirun -n 2");
    const double measured = hosts.round_trip_s(1);
    fmt::print("a message to rank 1 and back takes {:.1f} us\n", 1e6 * measured);
    const HostCost few = measure(hosts, options, kFew);
    const HostModel model = host_model(few, measure(hosts, options, kMany));
    fmt::print("\nreal-time factor by the model, hosts of {:g} cores; in brackets what limits it\n",
               options.cores);
    fmt::print("robots hosts  {:>21}  {:>21}  {:>21}\n", fmt::format("{:.1f} us", 1e6 * measured),
               fmt::format("{:g} us", 1e6 * kInfiniband), fmt::format("{:g} us", 1e6 * kEthernet));
    for (const int robots : {100, 500, 2000})
        for (const int count : {2, 8, 32}) {
            fmt::print("{:>6} {:>5}", robots, count);
            for (const double latency : {measured, kInfiniband, kEthernet}) {
                const HostEstimate one = estimate(model, robots, count, options.cores, latency);
                fmt::print("  {:>21}", fmt::format("{:.2g} ({})", one.real_time_factor, one.limit));
            }
            fmt::print("\n");
        }
    return 0;
}

}  // namespace

void declare_scale(Command& app, int& status, cosim::MpiHosts& hosts) {
    Command* command =
        app.add_subcommand("scale", "what more machines would gain, from two short runs (docs/hosts.md)");
    auto options = std::make_shared<ScaleOptions>();
    command->add_option("--duration", options->duration, "simulated time of each run (default: 0.5 s)")
        ->check(seconds_between(kShortest, kLongest))
        ->type_name("TIME");
    command->add_option("--cores", options->cores, "cores of a host that carry out boards (default: 16)")
        ->check(number_between(1, 1024))
        ->type_name("N");
    command->add_option("--out", options->out, "folder for the runs (default: out/scale)")
        ->check(not_empty())
        ->type_name("DIR");
    command->callback([options, &status, &hosts] { status = scale(hosts, *options); });
}

}  // namespace puckloop::tools
