#include "linuxboard/control/behaviours/serve.h"

#include "linuxboard/control/behaviours/steering.h"

#include <algorithm>
#include <cmath>

namespace puckloop::control {

namespace {

constexpr double kBoothCruise = 60.0;    // mm/s, towards the booth
constexpr double kCreep = 25.0;          // mm/s, between its sides
constexpr double kBack = 50.0;           // mm/s
constexpr double kBackFor = 4.0;         // s: 20 cm
constexpr double kStay = 8.0;            // s, without a camera
constexpr double kDark = 0.8;            // s without light: the task is done
constexpr double kWithin = 12.0;         // cm: a light of the booth that it stands in
constexpr double kBoothAhead = 1.2;      // rad to either side: a booth there is the one
constexpr double kAlign = 3.0;           // s, of it
constexpr double kStraight = 0.08;       // difference of the two front sensors, as a logarithm: a degree
constexpr double kPause = 5.0;           // s
constexpr double kPatience = 2.0;        // s before something that is no booth
constexpr double kLongestWay = 15.0;     // s, without a camera
constexpr double kLongestIn = 8.0;       // s, with one: it was seen from near
constexpr double kAlongside = 60.0;      // counts: a side of the booth, 15 mm away
constexpr double kAtBack = 900.0;        // counts: the booth's back, about 8 mm ahead
constexpr double kBoothNear = 120.0;     // counts: something about 5 cm away
constexpr double kBlocked = 400.0;       // counts: about 2 cm ahead; the mouth of a booth, askew, is less
constexpr double kSideTouching = 700.0;  // counts: the edge of a side, about 1 cm away
constexpr double kBend = 3.0;            // mm/s: backs away from it in an arc, by some 13 degrees
constexpr double kBoothTurnGain = 12.0;  // mm/s for a factor of e between two sensors, standing
constexpr double kSteerGain = 7.0;       // the same, driving
constexpr double kMostTurn = 20.0;       // mm/s
constexpr double kFaint = 40.0;          // counts: what is less shows nothing of the sides
constexpr std::uint8_t kServingLeds = 0xFF;

}  // namespace

void Serve::enter(State state, double t) {
    state_ = state;
    since_ = t;
    blocked_since_ = -1;
    bend_ = 0;
    lit_ = t;
    if (state == State::Stay) ++visits_;
}

bool Serve::between() const {
    return above_[2] > kAlongside && above_[5] > kAlongside;
}

/// Straight on, away from the nearer side.
Actuators Serve::approach(const Sensors& sensors, double t) {
    const double ahead = std::max(above_[0], above_[7]);
    const double right = between() ? above_[2] : above_[1], left = between() ? above_[5] : above_[6];
    if (between() && ahead > kAtBack) {
        enter(State::Stay, t);
        return {.ring_leds = kServingLeds};
    }
    const bool blocked = !between() && ahead > kBlocked;
    const bool touching = !between() && std::max(right, left) > kSideTouching;
    if (!blocked && !touching) blocked_since_ = -1;
    if ((blocked || touching) && blocked_since_ < 0) blocked_since_ = t;
    const bool stuck =
        t - since_ >
        (sensors.spots ? kLongestIn : kLongestWay);  // at a bumper's end, which is too low to be seen
    if (stuck || (blocked_since_ >= 0 && t - blocked_since_ > kPatience)) {
        enter(State::Leave, t);
        bend_ = right > left ? kBend : -kBend;
        return {.front_led = true};
    }
    if (blocked) return {.front_led = true};
    const bool open = std::max({above_[1], above_[2], above_[5], above_[6]}) < kAlongside;
    if (sensors.spots && open) {
        const std::optional<Actuators> way = towards_light(sensors);
        waiting_ = !way;
        if (waiting_) since_ = t;  // that is not being stuck
        return way.value_or(Actuators{});
    }
    const double turn =
        std::clamp(kSteerGain * (std::log(right + kFaint) - std::log(left + kFaint)), -kMostTurn, kMostTurn);
    const double speed = between() || touching ? kCreep : kBoothCruise;
    return {.left_mm_s = speed - turn, .right_mm_s = speed + turn};
}

std::optional<Actuators> Serve::towards_light(const Sensors& sensors) const {
    for (const ColouredSpot& spot : *sensors.spots)
        if (spot.colour != ColouredSpot::Colour::Red && std::abs(spot.bearing) < kBoothAhead)
            return drive_towards(spot.bearing, kBoothCruise);
    return std::nullopt;
}

bool Serve::done(const Sensors& sensors, double t) {
    if (!sensors.spots) return t - since_ >= kStay;
    for (const ColouredSpot& spot : *sensors.spots)
        if (spot.distance_cm < kWithin) lit_ = t;
    return t - since_ >= kAlign && t - lit_ >= kDark;
}

/// Turns until it looks straight at the booth's back, so that it leaves by the way that it came.
Actuators Serve::align() const {
    const double askew = std::log(above_[7] + kFaint) - std::log(above_[0] + kFaint);
    if (std::abs(askew) < kStraight) return {};
    const double turn = std::clamp(kBoothTurnGain * askew, -kMostTurn, kMostTurn);
    return {.left_mm_s = -turn, .right_mm_s = turn};
}

Actuators Serve::step(const Sensors& sensors, double t) {
    above_ = baseline_.above_offset(sensors.proximity);
    waiting_ = false;
    // Between the sides these are what the rear sensors see.
    const double behind = between() ? 0.0 : std::max(above_[3], above_[4]);
    Actuators out;
    switch (state_) {
    case State::Approach:
        out = approach(sensors, t);
        break;
    case State::Stay:
        if (t - since_ < kAlign) out = align();
        if (done(sensors, t)) enter(State::Leave, t);
        out.ring_leds = kServingLeds;
        break;
    case State::Leave:
        if (t - since_ >= kBackFor || behind > kBoothNear)
            enter(State::Pause, t);
        else
            out = {.left_mm_s = -kBack - bend_, .right_mm_s = -kBack + bend_};
        break;
    case State::Pause:
        if (t - since_ >= kPause) enter(State::Approach, t);
        break;
    }
    out.body_led = !sensors.battery_ok || state_ == State::Stay;
    return out;
}

}  // namespace puckloop::control
