#include "tools/guide/cost_estimate.h"

#include "benchmark/measures/reference.h"

#include <algorithm>

namespace puckloop::tools {

namespace {

// Wall-clock seconds a simulated second takes in one process, on an idle machine whose reference loop
// (benchmark/measures/reference.h) runs at kReference million steps a second. Made of the shipped scenarios:
// hello, swarm, own_rab, rab_pair, aggregation, tams18, tam_visit, virtual, ircom and bluetooth are met
// within a factor of 1.45, team, network and can within 2.4.
constexpr double kReference = 597;
constexpr double kBoardCost = 0.007, kProgramCost = 0.008;  // of a robot, and of its Linux program
constexpr double kRabCost = 0.065;                          // its range-and-bearing board, light and polling
constexpr double kIrcomCost = 0.03;
constexpr double kTamCost = 0.002;
constexpr double kHostCost = 0.08;  // a computer of the network with a program that waits for sockets
/// How many times longer with a process for each node: messages between them, which light makes many of.
constexpr double kManyProcesses = 3.0, kManyByRab = 0.32, kManyByTam = 0.2;

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
    double many = kManyProcesses;
    for (const scenarios::RobotBoards& robot : scenario.robots) {
        cost.one_process_s += kBoardCost + (robot.linux_board ? kProgramCost : 0.0) +
                              (robot.rab ? kRabCost : 0.0) + (scenario.world.ircom ? kIrcomCost : 0.0);
        many += robot.rab ? kManyByRab : 0.0;
    }
    cost.one_process_s += kTamCost * static_cast<double>(scenario.tams.size());
    cost.one_process_s += kHostCost * static_cast<double>(scenario.hosts.size());
    cost.one_process_s *= slowness();
    many += kManyByTam * static_cast<double>(scenario.tams.size());
    cost.many_processes_s = cost.one_process_s * many;
    cost.simulated_s = scenario.duration;
    return cost;
}

}  // namespace puckloop::tools
