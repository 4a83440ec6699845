#include "tools/guide/cost_estimate.h"

namespace puckloop::tools {

namespace {

// docs/performance.md, the table of commit 63190cf (two cores): a robot that wanders takes 12.9 ms a
// simulated second; swarm.toml, eight robots with range-and-bearing boards, runs at 1.87 times real time,
// which leaves 54 ms for board and light; tams18.toml runs at 20 times, 2.8 ms a TAM; hello.toml at 82.1
// times in one process and 19.9 times in many. Two hosts with asyncio take 0.2 s for 3 s.
constexpr double kHostCost = 0.033;
constexpr double kRobotCost = 0.0129, kRabCost = 0.054, kTamCost = 0.0028, kManyProcesses = 82.1 / 19.9;

}  // namespace

CostEstimate estimate_cost(const scenarios::Scenario& scenario) {
    CostEstimate cost;
    for (const scenarios::RobotBoards& robot : scenario.robots)
        cost.one_process_s += kRobotCost + (robot.rab ? kRabCost : 0.0);
    cost.one_process_s += kTamCost * static_cast<double>(scenario.tams.size());
    cost.one_process_s += kHostCost * static_cast<double>(scenario.hosts.size());
    cost.many_processes_s = cost.one_process_s * kManyProcesses;
    cost.simulated_s = scenario.duration;
    return cost;
}

}  // namespace puckloop::tools
