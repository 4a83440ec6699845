#pragma once
// Scenarios that are drawn from a seed. Together they have every kind of node; drawn_faults.h adds what goes
// wrong.

#include "tests/time_bounds/draw.h"

#include <string>

namespace puckloop::tests {

struct DrawnScenario {
    std::string toml;
    std::string script{};  ///< what "script:FILE" of the scenario plays; `kScript` is its name
    double seconds = 1;    ///< of simulated time
};

/// Name of the script's file, beside the scenario.
inline constexpr const char* kScript = "script.txt";

/// Two or three TAMs and a coordinator with a script or a program: resets, AT commands by line and over the
/// air, broadcasts, losses.
DrawnScenario draw_mesh(Draw& draw);
/// Robots with range-and-bearing boards and Linux programs.
DrawnScenario draw_rab(Draw& draw);
/// Robots that talk by Bluetooth, one of them with a computer.
DrawnScenario draw_bluetooth(Draw& draw);
/// Robots on a CAN bus.
DrawnScenario draw_can(Draw& draw);
/// IRcom between robots and a TAM.
DrawnScenario draw_ircom(Draw& draw);
/// A main board with its camera, and one whose Linux board has two.
DrawnScenario draw_camera(Draw& draw);
/// Any of these beside one another, with events in the world.
DrawnScenario draw_all(Draw& draw, bool with_tams);

/// A scenario's first tables, and a robot's, in which [robot.pic] is open for more keys. `place` counts from
/// the west.
std::string drawn_head(Draw& draw, double width, double depth);
std::string drawn_robot(Draw& draw, int place, const std::string& firmware, const std::string& keys = {});
/// A TAM's, in which [tam.xbee] is open.
std::string drawn_tam(Draw& draw, int number, double end);
/// Lines "<time_s> <hex bytes>" for a coordinator's radio module, API mode 2.
std::string drawn_requests(Draw& draw, double end);

}  // namespace puckloop::tests
