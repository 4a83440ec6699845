#include "physics/accelerometer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::physics {

namespace {
constexpr double kFullScale = 4095;
}

Accelerometer::Accelerometer(const AccelerometerParameters& parameters, const SimulationParameters& world)
    : parameters_(parameters),
      one_g_(world.gravity),
      share_(1.0 - std::exp(-2 * std::numbers::pi * parameters.bandwidth * kStepSeconds)) {
    const double gx = std::sin(world.slope_x);
    const double gy = std::sin(world.slope_y);
    gravity_ = {world.gravity * gx, world.gravity * gy, world.gravity * std::sqrt(1 - gx * gx - gy * gy)};
}

std::array<double, 3> Accelerometer::sense(const RobotState& robot) {
    if (first_) last_velocity_ = robot.velocity;
    std::array<double, 3> force{};  // specific force in the world's axes
    for (std::size_t i = 0; i < 3; ++i)
        force[i] = (robot.velocity[i] - last_velocity_[i]) / kStepSeconds + gravity_[i];
    last_velocity_ = robot.velocity;
    const double cosine = std::cos(robot.heading);
    const double sine = std::sin(robot.heading);
    const double level_forward = cosine * force[0] + sine * force[1];
    const double level_left = -sine * force[0] + cosine * force[1];
    const double pitch = std::sin(robot.pitch);
    const double roll = std::sin(robot.roll);
    // Pitch and roll are small: first order.
    const std::array<double, 3> own{level_forward - pitch * force[2], level_left + roll * force[2],
                                    force[2] + pitch * level_forward - roll * level_left};
    for (std::size_t i = 0; i < 3; ++i)
        filtered_[i] += (first_ ? 1.0 : share_) * (own[i] - filtered_[i]);
    first_ = false;
    const auto counts = [&](double acceleration, std::size_t axis) {
        return std::clamp(parameters_.zero + parameters_.bias[axis] +
                              parameters_.gain * acceleration / one_g_,
                          0.0, kFullScale);
    };
    return {counts(-filtered_[1], 0), counts(-filtered_[0], 1), counts(filtered_[2], 2)};
}

}  // namespace puckloop::physics
