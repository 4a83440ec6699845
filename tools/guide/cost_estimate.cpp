#include "tools/guide/cost_estimate.h"

#include "benchmark/reference.h"

#include <algorithm>

namespace puckloop::tools {

namespace {

// Seconds a simulated second takes on a machine whose reference loop (benchmark/reference.h) runs at
// kReference million steps a second; measured with the scenarios that are named, in one process
// (docs/performance.md).
constexpr double kReference = 580;
constexpr double kRobotCost = 0.0129;   // hello.toml: a robot that wanders
constexpr double kRabCost = 0.054;      // swarm.toml: its range-and-bearing board, light and polling
constexpr double kTamCost = 0.0028;     // tams18.toml
constexpr double kHostCost = 0.033;     // network.toml: a program with asyncio
constexpr double kManyProcesses = 4.1;  // hello.toml: what a process for each node costs more

/// How much slower than that machine this one is. The best of some looks: others may have the processor
/// meanwhile.
double slowness() {
    constexpr int kLooks = 5;
    constexpr double kLook = 0.004;  // s
    double best = 0.0;
    for (int i = 0; i < kLooks; ++i)
        best = std::max(best, reference_speed(kLook));
    return kReference / best;
}

}  // namespace

CostEstimate estimate_cost(const scenarios::Scenario& scenario) {
    CostEstimate cost;
    for (const scenarios::RobotBoards& robot : scenario.robots)
        cost.one_process_s += kRobotCost + (robot.rab ? kRabCost : 0.0);
    cost.one_process_s += kTamCost * static_cast<double>(scenario.tams.size());
    cost.one_process_s += kHostCost * static_cast<double>(scenario.hosts.size());
    cost.one_process_s *= slowness();
    cost.many_processes_s = cost.one_process_s * kManyProcesses;
    cost.simulated_s = scenario.duration;
    return cost;
}

}  // namespace puckloop::tools
