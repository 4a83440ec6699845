#include "run/nodes/bluetooth_nodes.h"

#include "physics/world/pose_signals.h"
#include "run/nodes/plan_kit.h"

#include <fmt/format.h>

namespace puckloop::tools {

namespace {

using scenarios::BluetoothModule;

constexpr const char* kNode = "bluetooth";
constexpr double kBluetoothBaud = 115200.0;  // of every module, and of a computer's line

bluetooth::RobotModule module_spec(const std::string& robot, std::size_t index,
                                   const BluetoothModule& module) {
    bluetooth::RobotModule spec;
    spec.module.name = robot;
    spec.module.settings.name = module.name;
    spec.module.settings.pin = module.pin;
    spec.module.settings.address = bluetooth::parse_address(robot, module.address);
    spec.module.settings.automatic = module.automatic;
    spec.module.boot = cosim::from_seconds(module.boot);
    // The world's signals begin with the robots' places.
    spec.pose = static_cast<int>(index * physics::kPoseSignals);
    return spec;
}

bluetooth::ComputerOptions computer_spec(const std::string& name, std::size_t index,
                                         const BluetoothModule& module) {
    bluetooth::ComputerOptions spec;
    spec.name = name;
    spec.address = bluetooth::parse_address(
        name, fmt::format("00:1A:7D:DA:{:02X}:{:02X}", index >> 8 & 0xff, index & 0xff));
    spec.robot = bluetooth::parse_address(name, module.address);
    spec.pin = module.pin;
    spec.connect = cosim::from_seconds(module.connect);
    return spec;
}

bluetooth::Spread spread_of(const std::vector<double>& mean_and_deviation) {
    return {mean_and_deviation.at(0), mean_and_deviation.at(1)};
}

}  // namespace

void add_bluetooth(RunSetup& setup, const RunRequest& request) {
    const scenarios::Scenario& scenario = setup.scenario;
    if (!scenarios::has_bluetooth(scenario)) return;
    bluetooth::AirSpec spec;
    for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
        const scenarios::RobotBoards& robot = scenario.robots[i];
        if (!robot.pic.bluetooth) continue;
        const BluetoothModule& module = *robot.pic.bluetooth;
        spec.modules.push_back(module_spec(robot.name, i, module));
        setup.links.push_back(
            {robot.name + ".bluetooth", {robot.name + ".pic", "uart1"}, {kNode, robot.name}, kBluetoothBaud});
        if (module.computer.empty()) continue;
        const std::string computer = robot.name + ".computer";
        spec.computers.push_back(computer_spec(computer, i, module));
        add_outside(setup, computer, module.computer, kBluetoothBaud, {kNode, computer}, kBluetoothBaud,
                    request);
    }
    const scenarios::BluetoothMedium& air = scenario.bluetooth;
    spec.name = kNode;
    spec.seed = scenario.seed;
    spec.range = air.range;
    spec.times.discovery = air.discovery;
    spec.times.name = spread_of(air.name_time);
    spec.times.link = spread_of(air.link_time);
    spec.times.release = spread_of(air.release_time);
    spec.csv = (setup.out / "bluetooth.csv").string();
    add_free(setup, kNode, std::move(spec));
    cosim::LinkSpec places{"bluetooth.world", {kNode, "world"}, {"world", "bluetooth"}};
    places.record_from_b = false;
    setup.links.push_back(places);
}

}  // namespace puckloop::tools
