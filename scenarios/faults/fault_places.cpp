#include "scenarios/faults/fault_places.h"

namespace puckloop::scenarios {

using cosim::PlaceKind;

std::vector<FaultPlace> fault_places(const Scenario& scenario) {
    std::vector<FaultPlace> places;
    const auto add_board = [&](const std::string& node, PlaceKind kind) {
        places.push_back({node, kind, {}, node, true});
    };
    for (const RobotBoards& robot : scenario.robots) {
        const std::string pic = robot.name + ".pic", program = robot.name + ".linux";
        if (robot.linux_board) places.push_back({robot.name + ".uart", PlaceKind::Uart, {program, pic}});
        std::vector<std::string> masters{pic};
        if (robot.linux_board) masters.push_back(program);
        places.push_back({robot.name + ".i2c", PlaceKind::I2c, masters, robot.name + ".i2c"});
        if (robot.linux_board) places.push_back({program, PlaceKind::Linux, {}, program, true});
        add_board(pic, PlaceKind::Pic);
        if (robot.rab) add_board(robot.name + ".rab", PlaceKind::Rab);
    }
    for (const TamBoard& tam : scenario.tams)
        add_board(tam.name + ".avr", PlaceKind::Tam);
    for (const TamBoard& tam : scenario.tams) {
        if (!tam.xbee.fitted) continue;
        places.push_back({tam.name + ".xbee", PlaceKind::Uart, {tam.name + ".avr", tam.name + ".xbee"}});
        places.push_back({tam.name + ".radio", PlaceKind::Radio, {tam.name + ".xbee", "ether"}});
    }
    if (scenario.coordinator) {
        if (!scenario.coordinator->uart.empty())
            places.push_back({"coordinator.uart", PlaceKind::Uart, {"coordinator.uart", "coordinator.xbee"}});
        if (scenario.coordinator->program)
            places.push_back({"coordinator.linux", PlaceKind::Linux, {}, "coordinator.linux", true});
        if (scenario.coordinator->program)
            places.push_back(
                {"coordinator.uart", PlaceKind::Uart, {"coordinator.linux", "coordinator.xbee"}});
        places.push_back({"coordinator.radio", PlaceKind::Radio, {"coordinator.xbee", "ether"}});
    }
    return places;
}

}  // namespace puckloop::scenarios
