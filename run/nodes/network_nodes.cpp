#include "run/nodes/network_nodes.h"

#include "physics/world/pose_signals.h"
#include "run/nodes/linux_nodes.h"
#include "run/nodes/plan_kit.h"
#include "scenarios/tables/network_tables.h"

#include <algorithm>

namespace puckloop::tools {

namespace {

constexpr const char* kNetwork = "network";

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

network::NetworkSpec network_spec(const scenarios::NetworkMedium& medium,
                                  const std::vector<scenarios::NetworkComputer>& computers) {
    network::NetworkSpec spec;
    spec.name = kNetwork;
    spec.prefix = medium.prefix;
    spec.latency = cosim::from_seconds(medium.latency) - 2 * kTransfer;
    spec.rate = medium.rate;
    spec.queue = medium.queue;
    for (const scenarios::NetworkComputer& one : computers)
        spec.stations.push_back({one.name, one.address});
    return spec;
}

static_assert(wifi::kObstacleSignals == physics::kShapeSignals);

/// Walls and things, as the radio meets them. Ids as of physics/world/pose_signals.h.
void add_obstacles(const physics::World& world, const wifi::WifiSettings& settings, wifi::WifiSpec& spec) {
    if (settings.wall_loss == 0 && settings.thing_loss == 0) return;
    const physics::SceneSignals signals{physics::moving_names(world).size()};
    spec.first_shape = static_cast<int>(signals.shape(true, 0));
    const auto obstacle = [](const std::string& name, const physics::Shape& shape, double loss) {
        const physics::ShapeValues values = physics::values_of(shape);
        return wifi::Obstacle{.name = name,
                              .box = values[0] != 0,
                              .x = values[1],
                              .y = values[2],
                              .heading = values[3],
                              .length = 2 * values[4],
                              .width = 2 * values[5],
                              .loss = loss};
    };
    const auto shapes = physics::fixed_shapes(world);
    const auto names = physics::fixed_names(world);
    const std::size_t walls = physics::built_in_count(world) + world.walls.size();
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        wifi::Obstacle one =
            obstacle(names[i], shapes[i], i < walls ? settings.wall_loss : settings.thing_loss);
        one.shape = static_cast<int>(signals.shape(true, i));
        spec.obstacles.push_back(std::move(one));
    }
    std::size_t moving = world.robots.size();
    const auto add = [&](const auto& things) {
        for (const auto& thing : things) {
            if (!thing.movable) continue;
            wifi::Obstacle one = obstacle(thing.name, physics::shape_of(thing), settings.thing_loss);
            one.pose = static_cast<int>(moving * physics::kPoseSignals);
            one.away = static_cast<int>(signals.out(moving));
            spec.obstacles.push_back(std::move(one));
            ++moving;
        }
    };
    add(world.boxes);
    add(world.cylinders);
}

wifi::WifiSpec wifi_spec(const RunSetup& setup, const std::vector<scenarios::NetworkComputer>& computers) {
    const scenarios::Scenario& scenario = setup.scenario;
    const scenarios::NetworkMedium& medium = *scenario.network;
    wifi::WifiSpec spec;
    spec.name = kNetwork;
    spec.seed = scenario.seed;
    spec.prefix = medium.prefix;
    spec.latency = cosim::from_seconds(medium.latency) - 2 * kTransfer;
    spec.queue = medium.queue;
    spec.settings = *medium.wifi;
    spec.access_point = medium.access_point;
    spec.csv = (setup.out / "wifi.csv").string();
    add_obstacles(scenario.world, spec.settings, spec);
    if (spec.settings.mesh) spec.routes_csv = (setup.out / "routes.csv").string();
    if (spec.settings.capture) spec.pcapng = (setup.out / "wifi.pcapng").string();
    for (const scenarios::NetworkComputer& one : computers) {
        wifi::WifiStation station{.computer = {one.name, one.address}};
        if (one.is_host) {
            const auto& position = scenario.hosts[one.index].position;
            station.wired = !position;
            if (position) station.at = *position;
        } else {
            const physics::Robot& body = scenario.world.robots[one.index];
            station.at = {body.x, body.y};
            // The world's signals begin with the robots' places.
            station.pose = static_cast<int>(one.index * physics::kPoseSignals);
        }
        spec.stations.push_back(std::move(station));
    }
    return spec;
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

bool hears_world(const scenarios::Scenario& scenario) {
    if (!scenario.network || !scenario.network->wifi) return false;
    if (scenario.network->wifi->wall_loss != 0 || scenario.network->wifi->thing_loss != 0) return true;
    const auto computers = scenarios::computers_of(scenario);
    return std::any_of(computers.begin(), computers.end(), [](const auto& one) { return !one.is_host; });
}

void add_network(RunSetup& setup, const RunRequest& request) {
    const scenarios::Scenario& scenario = setup.scenario;
    if (!scenario.network) return;
    for (const scenarios::ComputerHost& host : scenario.hosts)
        add_host(setup, host, request);
    const std::vector<scenarios::NetworkComputer> computers = scenarios::computers_of(scenario);
    for (const scenarios::NetworkComputer& one : computers) {
        cosim::LinkSpec link{one.name + ".network", {one.name + ".linux", kNetwork}, {kNetwork, one.name}};
        link.latency = kTransfer;
        setup.links.push_back(link);
    }
    if (computers.empty()) return;
    if (scenario.network->wifi)
        add_free(setup, kNetwork, wifi_spec(setup, computers));
    else
        add_free(setup, kNetwork, network_spec(*scenario.network, computers));
    if (!hears_world(scenario)) return;
    cosim::LinkSpec places{"network.world", {kNetwork, "world"}, {"world", kNetwork}};
    places.record_from_b = false;
    setup.links.push_back(places);
}

void add_messages(RunSetup& setup) {
    if (scenarios::computers_of(setup.scenario).empty()) return;
    // Not in trace.csv: what was sent is in the world's log, and arrives as a packet.
    cosim::LinkSpec messages{"network.messages", {kNetwork, "messages"}, {"world", "messages"}};
    messages.record_from_b = false;
    messages.hashed_when_unused = false;
    setup.links.push_back(messages);
}

}  // namespace puckloop::tools
