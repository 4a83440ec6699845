#include "physics/robot/wheel_drive.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::physics {

namespace {
constexpr double kPolePair = 4.0;    // steps after which the coils' pattern repeats
constexpr double kFallsBack = 0.25;  // least share of its steps that a rotor misses until a group is lost
constexpr double kOverdue = 1.5;     // intervals after which no further step is expected
constexpr double kSlowest = 0.2;     // s: steps further apart do not drive a wheel
constexpr double kStands = 0.1;      // s without a step: the motor stands
}  // namespace

WheelDrive::WheelDrive(const BodyParameters& parameters, RandomStream losses)
    : parameters_(parameters),
      losses_(losses),
      radians_per_step_(2 * std::numbers::pi / parameters.steps_per_turn) {}

void WheelDrive::step_to(double steps, double seconds) {
    if (steps == steps_) return;
    from_ = rotor(seconds);
    begun_ = seconds;
    const double interval = seconds - last_step_;
    duration_ = interval <= parameters_.smoothing_limit ? interval : parameters_.settle_time;
    interval_ = interval;
    last_step_ = seconds;
    const double change = steps - steps_;
    change_ = change;
    steps_ = steps;
    if (parameters_.step_loss_speed > 0.0) lose_at_speed(change, interval);
    if (parameters_.deadband > 0.0) hold_if_slow(change, interval);
}

/// A rotor that falls out of step runs slower until the coils' pattern has come round to it: the robot's mass
/// carries it on, and nothing throws it back.
void WheelDrive::lose_at_speed(double change, double interval) {
    const double speed = std::abs(change) / std::max(interval, 1e-6);
    const double x = (speed - parameters_.step_loss_speed) / parameters_.step_loss_width;
    const double share = 1.0 / (1.0 + std::exp(-x));
    if (change * to_lose_ < 0 || interval > kStands) to_lose_ = 0.0;
    if (losses_.uniform() < share * std::abs(change) / kPolePair)
        to_lose_ += std::copysign(kPolePair, change);
    const double slower = (share + (1 - share) * kFallsBack) * std::abs(change);
    const double missed = std::copysign(std::min(std::abs(to_lose_), slower), change);
    to_lose_ -= missed;
    lost_ += missed;
}

/// Of steps that are too slow the rotor leans towards the last one only: whether it is the first of a drive
/// is not known before the next.
void WheelDrive::hold_if_slow(double change, double interval) {
    if (std::abs(change) >= parameters_.deadband * interval) {
        held_ = 0.0;
        return;
    }
    const double lean = std::clamp(change, -1.0, 1.0);
    lost_ += held_ + change - lean;
    held_ = lean;
}

double WheelDrive::rotor(double seconds) const {
    const double goal = steps_ - lost_;
    if (seconds >= begun_ + duration_) return goal;
    return from_ + (goal - from_) * (seconds - begun_) / duration_;
}

double WheelDrive::angle(double seconds) {
    const double driven = rotor(seconds) * radians_per_step_;
    const double play = parameters_.backlash / 2;
    geared_ = std::clamp(geared_, driven - play, driven + play);
    return geared_;
}

double WheelDrive::pull_out(double wheel_angle) {
    const double lag = (geared_ - wheel_angle) / radians_per_step_;
    if (std::abs(lag) <= parameters_.pull_out_steps) return 0.0;
    const double pairs = std::ceil((std::abs(lag) - parameters_.pull_out_steps) / kPolePair);
    const double slip = std::copysign(pairs * kPolePair, lag);
    lost_ += slip;
    from_ -= slip;
    geared_ -= slip * radians_per_step_;
    return slip * radians_per_step_;
}

double WheelDrive::speed(double seconds) const {
    const double since = seconds - last_step_;
    return since > kStands ? 0.0 : std::abs(change_) / std::max({interval_, since, 1e-6});
}

bool WheelDrive::running(double seconds) const {
    return seconds - last_step_ <= parameters_.smoothing_limit;
}

double WheelDrive::driven_for(double interval, const BodyParameters& parameters) {
    return std::max(parameters.smoothing_limit, interval <= kSlowest ? kOverdue * interval : 0.0);
}

bool WheelDrive::driven(double seconds) const {
    return seconds - last_step_ <= driven_for(interval_, parameters_);
}

}  // namespace puckloop::physics
