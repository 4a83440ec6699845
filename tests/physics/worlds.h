#pragma once
// Small worlds and driving helpers shared by the physics tests.

#include "physics/world/world_model.h"

#include <cmath>
#include <string>

namespace puckloop::physics::test {

inline Robot robot_at(const std::string& name, double x, double y, double heading = 0.0) {
    Robot robot;
    robot.name = name;
    robot.x = x;
    robot.y = y;
    robot.heading = heading;
    return robot;
}

/// An arena of `width` x `depth` with one robot "e1" in the middle, facing +x.
inline World world_with_robot(double width = 2.0, double depth = 2.0) {
    World world;
    world.arena = rectangular_arena(width, depth);
    world.robots.push_back(robot_at("e1", 0, 0));
    return world;
}

/// Feeds evenly spaced motor steps, as an emulated board would, and steps the world.
class Driver {
  public:
    explicit Driver(WorldModel& world, std::size_t robot = 0) : world_(world), robot_(robot) {}

    /// Steps per second on each side, for `seconds`, then the world has advanced by as much.
    void drive(double left, double right, double seconds) {
        const auto steps = static_cast<int>(std::lround(seconds * 1e3));
        for (int i = 0; i < steps; ++i) {
            feed(left, right);
            world_.step();
        }
    }
    /// The motor steps of the millisecond to come; the caller steps the world.
    void feed(double left, double right) {
        const double now = world_.seconds();
        feed_side(Side::Left, left, now, phase_[0], count_[0]);
        feed_side(Side::Right, right, now, phase_[1], count_[1]);
    }
    double steps(Side side) const { return count_[static_cast<std::size_t>(side)]; }

  private:
    void feed_side(Side side, double rate, double now, double& phase, double& count) {
        double used = 0.0;  // share of the millisecond gone by
        const double per_step = std::abs(rate) * kStepSeconds;
        while (per_step > 0 && phase + (1.0 - used) * per_step >= 1.0) {
            used += (1.0 - phase) / per_step;
            phase = 0.0;
            count += rate > 0 ? 1.0 : -1.0;
            world_.wheel(robot_, side, count, now + used * kStepSeconds * 0.999999);
        }
        phase += (1.0 - used) * per_step;
    }

    WorldModel& world_;
    std::size_t robot_;
    double phase_[2]{};
    double count_[2]{};
};

}  // namespace puckloop::physics::test
