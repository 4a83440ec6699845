#include "linuxboard/control/behaviours/steering.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::control {

namespace {

constexpr double kTurnGain = 60.0;      // mm/s per radian off
constexpr double kMaximumTurn = 70.0;   // mm/s
constexpr double kFelt = 120.0;         // counts: something about 5 cm away
constexpr double kSameDirection = 0.7;  // rad between a neighbour's bearing and a sensor's
constexpr double kLeds = 8;

}  // namespace

double wrapped(double angle) {
    return std::remainder(angle, 2 * std::numbers::pi);
}

Actuators steer(double forward, double turn) {
    Actuators out;
    out.left_mm_s = forward - turn;
    out.right_mm_s = forward + turn;
    return out;
}

Actuators drive_towards(double bearing, double speed) {
    const double turn = std::clamp(kTurnGain * bearing, -kMaximumTurn, kMaximumTurn);
    return steer(speed * std::max(0.0, std::cos(bearing)), turn);
}

bool touches(const std::array<double, 8>& proximity, double bearing) {
    for (std::size_t i = 0; i < proximity.size(); ++i)
        if (proximity[i] > kFelt && std::abs(wrapped(kRingBearing[i] - bearing)) < kSameDirection)
            return true;
    return false;
}

std::uint8_t led_towards(double bearing) {
    const double turns = -wrapped(bearing) / (2 * std::numbers::pi);  // LEDs count clockwise
    const int led = static_cast<int>(std::lround(kLeds * turns) + 8) % 8;
    return static_cast<std::uint8_t>(1 << led);
}

}  // namespace puckloop::control
