#pragma once
// What the sensor models of one robot look at.

#include "physics/description/plan.h"
#include "physics/dynamics/dynamics.h"

#include <cmath>
#include <span>

namespace puckloop::physics {

/// `shapes` are all upright things but the robot itself.
struct SensorView {
    const RobotState& robot;
    std::span<const Shape* const> shapes;
    double seconds = 0.0;
};

/// What else a reading depends on, besides what a sensor sees.
struct Surroundings {
    double seconds = 0.0;
    double ambient = 0.0;      ///< room light, 0 dark, 1 a lit room
    double battery = 3.7;      ///< V
    double motors = 0.0;       ///< share of the two motors that step
    double motor_speed = 0.0;  ///< steps/s without sign, mean of the two
};

/// Share of a drift with time constant `time` (s) that has happened by now.
inline double warmed_up(double seconds, double time) {
    return 1.0 - std::exp(-seconds / time);
}

/// A point of the robot (x forward, y left) and a direction, in the world's plan.
struct Ray {
    double x, y, dx, dy;
};
inline Ray in_world(const RobotState& robot, double cosine, double sine, const Ray& own) {
    return {robot.x + cosine * own.x - sine * own.y, robot.y + sine * own.x + cosine * own.y,
            cosine * own.dx - sine * own.dy, sine * own.dx + cosine * own.dy};
}

}  // namespace puckloop::physics
