#include "linuxboard/control/behaviours/wander.h"

#include <algorithm>
#include <cmath>

namespace puckloop::control {

namespace {

constexpr double kWanderCruise = 80.0;  // mm/s
constexpr double kTurn = 40.0;          // mm/s, both wheels, opposite: 1.5 rad/s
constexpr double kWallNear = 120.0;     // counts: a wall about 5 cm ahead
constexpr double kClear = 60.0;         // counts: turn until less than this
constexpr double kShortestTurn = 0.3;   // s
constexpr double kGoldenRatio = 0.6180339887;

}  // namespace

std::array<double, 8> ProximityBaseline::above_offset(const std::array<double, 8>& proximity) {
    std::array<double, 8> above{};
    for (std::size_t i = 0; i < proximity.size(); ++i) {
        offset_[i] = learnt_ ? std::min(offset_[i], proximity[i]) : std::min(proximity[i], kWallNear);
        above[i] = proximity[i] - offset_[i];
    }
    learnt_ = true;
    return above;
}

Actuators Wander::step(const Sensors& sensors, double t) {
    above_ = baseline_.above_offset(sensors.proximity);
    const std::array<double, 8>& p = above_;
    const double right = std::max({p[0], p[1], p[2] / 3});  // a wall alongside matters less than one ahead
    const double left = std::max({p[7], p[6], p[5] / 3});
    if (turning_ == 0 && std::max(left, right) > kWallNear) {
        turning_ = left > right ? -1 : 1;
        ++turns_;
        turn_at_least_ = t + kShortestTurn + turn_spread_ * std::fmod(kGoldenRatio * turns_, 1.0);
    } else if (turning_ != 0 && t >= turn_at_least_ && std::max(left, right) < kClear) {
        turning_ = 0;
    }
    Actuators out;
    if (turning_ == 0) {
        out.left_mm_s = kWanderCruise;
        out.right_mm_s = kWanderCruise;
    } else {
        out.left_mm_s = -turning_ * kTurn;
        out.right_mm_s = turning_ * kTurn;
        out.ring_leds = turning_ > 0 ? 0x02 : 0x80;  // the LED on the obstacle's side
    }
    out.front_led = turning_ != 0;
    out.body_led = !sensors.battery_ok;
    return out;
}

}  // namespace puckloop::control
