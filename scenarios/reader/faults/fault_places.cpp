#include "scenarios/reader/faults/fault_places.h"

#include "scenarios/tables/network_tables.h"

namespace puckloop::scenarios {

using cosim::PlaceKind;

namespace {

/// What carries radio frames and IRcom words; a fault may be for those from or to one of its devices.
void add_media(const Scenario& scenario, std::vector<FaultPlace>& places) {
    FaultPlace ether{"ether", PlaceKind::Xbee, {}, "ether", true},
        ircom{"ircom", PlaceKind::Ircom, {}, "ircom", true};
    if (scenario.coordinator) ether.ends.emplace_back("coordinator");
    for (const RobotBoards& robot : scenario.robots)
        ircom.ends.push_back(robot.name);
    for (const TamBoard& tam : scenario.tams) {
        if (tam.xbee.fitted) ether.ends.push_back(tam.name);
        ircom.ends.push_back(tam.name);
    }
    FaultPlace network{"network", PlaceKind::Network, {}, "network", true};
    for (const NetworkComputer& computer : computers_of(scenario))
        network.ends.push_back(computer.name);
    if (!network.ends.empty()) places.push_back(std::move(network));
    for (const ComputerHost& host : scenario.hosts)
        places.push_back({host.name + ".linux", PlaceKind::Linux, {}, host.name + ".linux", true});
    if (!ether.ends.empty()) places.push_back(std::move(ether));
    if (scenario.world.ircom) places.push_back(std::move(ircom));
}

}  // namespace

std::vector<FaultPlace> fault_places(const Scenario& scenario) {
    std::vector<FaultPlace> places;
    const auto add_board = [&](const std::string& node, PlaceKind kind) {
        places.push_back({node, kind, {}, node, true});
    };
    for (const RobotBoards& robot : scenario.robots) {
        const std::string pic = robot.name + ".pic", program = robot.name + ".linux";
        if (robot.linux_board) places.push_back({robot.name + ".uart", PlaceKind::Uart, {program, pic}});
        if (robot.pic.bluetooth)
            places.push_back({robot.name + ".bluetooth", PlaceKind::Uart, {pic, "bluetooth"}});
        const std::string computer = robot.name + ".computer";
        if (robot.pic.bluetooth && !robot.pic.bluetooth->computer.empty())
            places.push_back({computer, PlaceKind::Uart, {computer, "bluetooth"}});
        if (!robot.pic.uart1.empty())
            places.push_back({robot.name + ".uart1", PlaceKind::Uart, {robot.name + ".uart1", pic}});
        if (!robot.pic.uart2.empty())
            places.push_back({robot.name + ".uart2", PlaceKind::Uart, {robot.name + ".uart2", pic}});
        std::vector<std::string> masters{pic};
        if (robot.linux_board) masters.push_back(program);
        places.push_back({robot.name + ".i2c", PlaceKind::I2c, masters, robot.name + ".i2c"});
        if (robot.linux_board) places.push_back({program, PlaceKind::Linux, {}, program, true});
        add_board(pic, PlaceKind::Pic);
        if (!robot.rab) continue;
        add_board(robot.name + ".rab", PlaceKind::Rab);
        places.push_back({robot.name + ".ir", PlaceKind::InfraRed, {robot.name + ".rab", "ir"}, "ir"});
    }
    for (const TamBoard& tam : scenario.tams)
        add_board(tam.name + ".avr", PlaceKind::Tam);
    for (const TamBoard& tam : scenario.tams) {
        const std::string console = tam.name + ".console";
        if (!tam.console.empty()) places.push_back({console, PlaceKind::Uart, {console, tam.name + ".avr"}});
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
    add_media(scenario, places);
    for (const CanBus& bus : scenario.can_buses) {
        FaultPlace place{bus.name, PlaceKind::Can, {}, bus.name};
        for (const CanController& controller : bus.controllers)
            place.ends.push_back(controller.name());
        places.push_back(std::move(place));
    }
    return places;
}

}  // namespace puckloop::scenarios
