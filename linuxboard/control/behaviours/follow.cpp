#include "linuxboard/control/behaviours/follow.h"

#include "linuxboard/control/behaviours/steering.h"

#include <algorithm>

namespace puckloop::control {

namespace {

constexpr double kDistance = 12.0;    // cm to keep
constexpr double kApproach = 6.0;     // mm/s per cm beyond it
constexpr double kFastest = 110.0;    // mm/s
constexpr double kLeading = 0.5;      // of the speed of wandering: the others must be able to keep up
constexpr double kTouching = 45.0;    // cm: what is felt in its direction may be the leader
constexpr double kSearch = 3.0;       // s of turning after the leader was lost
constexpr double kSearchTurn = 30.0;  // mm/s

}  // namespace

Actuators Follow::step(const Sensors& sensors, double t) {
    const Actuators wandering = wander_.step(sensors, t);
    const Neighbour* leader = nullptr;
    for (const Neighbour& one : sensors.neighbours)
        if (one.id < own_id_ && (leader == nullptr || one.id > leader->id)) leader = &one;
    Actuators out;
    if (leader != nullptr) {
        heard_ = t;
        last_bearing_ = leader->bearing;
        out = pursue(*leader, wandering);
    } else {
        out = lead_or_search(t, wandering);
    }
    out.body_led = !sensors.battery_ok;
    return out;
}

Actuators Follow::pursue(const Neighbour& leader, const Actuators& wandering) {
    const bool touching = leader.range_cm < kTouching && touches(wander_.above_offset(), leader.bearing);
    if (wander_.avoiding() && !touching) return wandering;
    const double speed = std::clamp(kApproach * (leader.range_cm - kDistance), 0.0, kFastest);
    Actuators out = drive_towards(leader.bearing, touching ? 0 : speed);
    out.ring_leds = led_towards(leader.bearing);
    return out;
}

Actuators Follow::lead_or_search(double t, Actuators wandering) const {
    if (wander_.avoiding()) return wandering;
    if (heard_ >= 0 && t - heard_ < kSearch) return steer(0, last_bearing_ < 0 ? -kSearchTurn : kSearchTurn);
    wandering.left_mm_s *= kLeading;
    wandering.right_mm_s *= kLeading;
    wandering.front_led = true;
    return wandering;
}

}  // namespace puckloop::control
