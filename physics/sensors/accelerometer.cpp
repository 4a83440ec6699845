#include "physics/sensors/accelerometer.h"

#include "physics/description/robot_constants.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::physics {

namespace {
constexpr double kAccelerometerFullScale = 4095;
}  // namespace

Accelerometer::Accelerometer(const AccelerometerParameters& parameters, const SimulationParameters& world,
                             std::uint64_t seed, const std::string& robot)
    : vibration_(seed, "physics/" + robot + "/vibration"), one_g_(world.gravity) {
    set_parameters(parameters);
    const double gx = std::sin(world.slope_x);
    const double gy = std::sin(world.slope_y);
    gravity_ = {world.gravity * gx, world.gravity * gy, world.gravity * std::sqrt(1 - gx * gx - gy * gy)};
}

void Accelerometer::set_parameters(const AccelerometerParameters& parameters) {
    parameters_ = parameters;
    share_ = 1.0 - std::exp(-2 * std::numbers::pi * parameters.bandwidth * kStepSeconds);
    turn_cosine_ = std::cos(parameters.turn);
    turn_sine_ = std::sin(parameters.turn);
    for (std::size_t axis = 0; axis < 3; ++axis)
        zero_[axis] = parameters.zero + parameters.bias[axis];
}

std::array<double, 3> Accelerometer::sense(const RobotState& robot, const Surroundings& now) {
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
    const auto& p = parameters_;
    const double right = -filtered_[1];
    const double rear = -filtered_[0];
    const std::array<double, 3> felt{turn_cosine_ * right + turn_sine_ * rear,
                                     turn_cosine_ * rear - turn_sine_ * right, filtered_[2]};
    const double drift = p.warmup == 0.0 ? 0.0 : p.warmup * warmed_up(now.seconds, p.warmup_time);
    const double shake = p.vibration * now.motor_speed / kSpeedUnit;
    std::array<double, 3> counts{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        counts[axis] = zero_[axis] + p.gain * p.scale[axis] * felt[axis] / one_g_ + drift;
        counts[axis] *= 1.0 - p.motor_sag * now.motors;
        if (shake > 0.0) counts[axis] += shake * vibration_.normal();
        in_g_[axis] = (counts[axis] - p.zero) / p.gain;
        counts[axis] = std::clamp(counts[axis], 0.0, kAccelerometerFullScale);
    }
    in_g_ = {-in_g_[1], -in_g_[0], in_g_[2]};
    return counts;
}

}  // namespace puckloop::physics
