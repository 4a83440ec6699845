#include "linuxboard/control/behaviours/drive_to_light.h"

#include <algorithm>
#include <cmath>

namespace puckloop::control {

namespace {

constexpr double kLightCruise = 70.0;       // mm/s
constexpr double kLightTurnGain = 45.0;     // mm/s per radian of bearing error
constexpr double kLightMaximumTurn = 60.0;  // mm/s
constexpr double kContrast = 40.0;    // counts between brightest and darkest: less is no direction at all
constexpr double kDazzling = 3400.0;  // counts: so bright that the lamp is reached
constexpr double kBright =
    1500.0;                       // counts: it is near; its light weakens again when the robot gets below it
constexpr double kPassed = 0.93;  // of the brightest so far
constexpr double kAligned = 0.3;  // radians: the lamp is ahead
constexpr double kGone = 0.5;     // of the brightest so far: the lamp or the robot was moved
constexpr std::uint8_t kLightArrivedLeds = 0xFF;

}  // namespace

Actuators DriveToLight::step(const Sensors& sensors, double t) {
    const auto [darkest, brightest] = std::minmax_element(sensors.light.begin(), sensors.light.end());
    double ahead = 0;
    double leftward = 0;
    for (std::size_t i = 0; i < sensors.light.size(); ++i) {
        const double weight = sensors.light[i] - *darkest;
        ahead += weight * std::cos(kRingBearing[i]);
        leftward += weight * std::sin(kRingBearing[i]);
    }
    const double bearing = std::atan2(leftward, ahead);
    watch_arrival(*brightest, std::abs(bearing) < kAligned);

    const Actuators wandering = wander_.step(sensors, t);
    if (arrived_) return {.ring_leds = kLightArrivedLeds, .body_led = true};
    if (wander_.avoiding() || *brightest - *darkest < kContrast) return wandering;
    const double turn = std::clamp(kLightTurnGain * bearing, -kLightMaximumTurn, kLightMaximumTurn);
    const double forward = kLightCruise * std::max(0.0, std::cos(bearing));
    return {.left_mm_s = forward - turn, .right_mm_s = forward + turn, .front_led = true};
}

/// Brightness means distance only while the lamp is ahead: turning changes it too.
void DriveToLight::watch_arrival(double brightest, bool aligned) {
    if (arrived_ && brightest < kGone * peak_) {
        arrived_ = false;
        peak_ = 0;
    }
    if (!aligned) return;
    peak_ = std::max(peak_, brightest);
    if (brightest > kDazzling || (brightest > kBright && brightest < kPassed * peak_)) arrived_ = true;
}

}  // namespace puckloop::control
