#include "run/nodes/network_nodes.h"

#include "run/nodes/linux_nodes.h"
#include "run/nodes/plan_kit.h"
#include "scenarios/tables/network_tables.h"

namespace puckloop::tools {

namespace {

constexpr const char* kNetwork = "network";

/// Between a computer and the network, each way: part of the latency. More than nothing, so that neither
/// waits for the other where both are due at the same time.
constexpr cosim::Time kTransfer = cosim::kMicrosecond;

void add_host(RunSetup& setup, const scenarios::ComputerHost& host, const RunRequest& request) {
    const std::string node = host.name + ".linux";
    LinuxProgram spec = linux_program(setup, node, host.board, request);
    linuxboard::LinuxSpec& program = spec.program;
    program.tty.clear();
    program.tty_aliases.clear();
    program.i2c.clear();
    program.exit_ends_run = false;  // the robots' programs end the run
    join_network(setup, host.name, spec);
    setup.nodes.push_back({node, {std::move(spec)}});
}

}  // namespace

void join_network(const RunSetup& setup, const std::string& computer, LinuxProgram& program) {
    const scenarios::Scenario& scenario = setup.scenario;
    if (!scenario.network) return;
    linuxboard::NetworkSpec& spec = program.program.network.emplace();
    spec.prefix = scenario.network->prefix;
    for (const scenarios::NetworkComputer& one : scenarios::computers_of(scenario)) {
        spec.names.push_back({one.name, one.address});
        if (one.name == computer) spec.address = one.address;
    }
    // A board may call itself otherwise.
    for (const scenarios::NetworkComputer& one : scenarios::computers_of(scenario))
        for (const scenarios::RobotBoards& robot : scenario.robots)
            if (robot.name == one.name && robot.linux_board && robot.linux_board->hostname != one.name)
                spec.names.push_back({robot.linux_board->hostname, one.address});
}

void add_network(RunSetup& setup, const RunRequest& request) {
    const scenarios::Scenario& scenario = setup.scenario;
    if (!scenario.network) return;
    for (const scenarios::ComputerHost& host : scenario.hosts)
        add_host(setup, host, request);
    network::NetworkSpec spec;
    spec.name = kNetwork;
    spec.prefix = scenario.network->prefix;
    spec.latency = cosim::from_seconds(scenario.network->latency) - 2 * kTransfer;
    spec.rate = scenario.network->rate;
    spec.queue = scenario.network->queue;
    for (const scenarios::NetworkComputer& one : scenarios::computers_of(scenario)) {
        spec.stations.push_back({one.name, one.address});
        cosim::LinkSpec link{one.name + ".network", {one.name + ".linux", kNetwork}, {kNetwork, one.name}};
        link.latency = kTransfer;
        setup.links.push_back(link);
    }
    if (!spec.stations.empty()) add_free(setup, kNetwork, std::move(spec));
}

}  // namespace puckloop::tools
