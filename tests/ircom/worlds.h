#pragma once
// Worlds of robots and booths, and ids, for tests of the medium alone.

#include "cosim/core/message.h"
#include "physics/ircom/ircom_node.h"

#include <string>

namespace puckloop::ircom_test {

using cosim::Message;
using cosim::PortIndex;
using cosim::Signal;
using cosim::Time;

/// Any numbers.
inline const physics::IrcomIds kIds{{3, 4, 9, 5}, {20, 21, 22, 23, 24, 25, 26, 28}, 7, 8};
inline constexpr Time kDelay = 20 * cosim::kMicrosecond;  // ircom.delay

inline physics::World world(double size = 2.0) {
    physics::World world;
    world.arena = physics::rectangular_arena(size, size);
    world.ircom = true;
    return world;
}
inline void add_robot(physics::World& world, const std::string& name, double x, double y, double heading) {
    physics::Robot robot;
    robot.name = name;
    robot.x = x;
    robot.y = y;
    robot.heading = heading;
    world.robots.push_back(robot);
}
inline void add_booth(physics::World& world, const std::string& name, double x, double y, double heading) {
    physics::Booth booth;
    booth.name = name;
    booth.x = x;
    booth.y = y;
    booth.heading = heading;
    world.booths.push_back(booth);
}

}  // namespace puckloop::ircom_test
