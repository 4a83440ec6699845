#include "run/plan/bluetooth_nodes.h"

#include "physics/world/pose_signals.h"
#include "run/plan/plan_kit.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace puckloop::tools {

namespace {

using nlohmann::json;
using scenarios::BluetoothModule;

constexpr const char* kNode = "bluetooth";
constexpr double kBaud = 115200.0;  // of every module, and of a computer's line

json module_spec(const std::string& robot, std::size_t index, const BluetoothModule& module) {
    return {{"name", robot},
            {"friendly_name", module.name},
            {"pin", module.pin},
            {"address", module.address},
            {"automatic", module.automatic},
            {"boot_s", module.boot},
            // The world's signals begin with the robots' places.
            {"pose", index * physics::kPoseSignals}};
}

json computer_spec(const std::string& name, std::size_t index, const BluetoothModule& module) {
    return {{"name", name},
            {"address", fmt::format("00:1A:7D:DA:{:02X}:{:02X}", index >> 8 & 0xff, index & 0xff)},
            {"robot", module.address},
            {"pin", module.pin},
            {"connect_s", module.connect}};
}

}  // namespace

void add_bluetooth(RunSetup& setup, const RunRequest& request) {
    const scenarios::Scenario& scenario = setup.scenario;
    if (!scenarios::has_bluetooth(scenario)) return;
    json modules = json::array(), computers = json::array();
    for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
        const scenarios::RobotBoards& robot = scenario.robots[i];
        if (!robot.pic.bluetooth) continue;
        const BluetoothModule& module = *robot.pic.bluetooth;
        modules.push_back(module_spec(robot.name, i, module));
        setup.links.push_back(
            {robot.name + ".bluetooth", {robot.name + ".pic", "uart1"}, {kNode, robot.name}, kBaud});
        if (module.computer.empty()) continue;
        const std::string computer = robot.name + ".computer";
        computers.push_back(computer_spec(computer, i, module));
        add_outside(setup, computer, module.computer, kBaud, {kNode, computer}, kBaud, request);
    }
    const scenarios::BluetoothMedium& air = scenario.bluetooth;
    add_free(setup, kNode,
             {{"kind", "bluetooth"},
              {"name", kNode},
              {"seed", scenario.seed},
              {"range_m", air.range},
              {"discovery_s", air.discovery},
              {"name_s", air.name_time},
              {"link_s", air.link_time},
              {"release_s", air.release_time},
              {"modules", std::move(modules)},
              {"computers", std::move(computers)},
              {"csv", (setup.out / "bluetooth.csv").string()}});
    cosim::LinkSpec places{"bluetooth.world", {kNode, "world"}, {"world", "bluetooth"}};
    places.record_from_b = false;
    setup.links.push_back(places);
}

}  // namespace puckloop::tools
