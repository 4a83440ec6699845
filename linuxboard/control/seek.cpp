#include "linuxboard/control/seek.h"

#include "linuxboard/control/steering.h"

#include <algorithm>
#include <cmath>

namespace puckloop::control {

namespace {

constexpr double kSpeed = 60.0;      // mm/s, towards the light
constexpr double kBeside = 22.0;     // cm: nearer than that the booth's sides are no obstacles
constexpr double kAtMouth = 17.0;    // cm, from its lights: about to drive in
constexpr double kAhead = 0.25;      // rad: it is straight ahead
constexpr double kBooth = 10.0;      // cm
constexpr double kForget = 1.5;      // s without seeing it
constexpr double kTurnAway = 2.1;    // s: half a turn
constexpr double kTurnSpeed = 40.0;  // mm/s
constexpr double kAskew = 0.8;       // s of turning aside: some 70 degrees
constexpr double kAside = 1.8;       // s of driving there: 11 cm
constexpr double kRest = 8.0;        // s in which no booth is looked for
constexpr std::uint8_t kFrontLeds = 0x83;

/// The lights of one booth as one: spots of a colour that are less than a booth's width apart. Aiming at a
/// single one of its three lights a robot would meet the side beside it.
std::vector<ColouredSpot> joined(const std::vector<ColouredSpot>& spots) {
    struct Sum {
        ColouredSpot::Colour colour;
        double ahead = 0, left = 0, area = 0;
    };
    std::vector<Sum> sums;
    for (const ColouredSpot& spot : spots) {
        const double ahead = spot.distance_cm * std::cos(spot.bearing);
        const double left = spot.distance_cm * std::sin(spot.bearing);
        const auto near = [&](const Sum& sum) {
            return sum.colour == spot.colour &&
                   std::hypot(sum.ahead / sum.area - ahead, sum.left / sum.area - left) < kBooth;
        };
        auto sum = std::find_if(sums.begin(), sums.end(), near);
        if (sum == sums.end()) sum = sums.insert(sums.end(), Sum{spot.colour});
        sum->ahead += spot.area * ahead;
        sum->left += spot.area * left;
        sum->area += spot.area;
    }
    std::vector<ColouredSpot> booths;
    for (const Sum& sum : sums)
        booths.push_back({sum.colour, std::atan2(sum.left, sum.ahead),
                          std::hypot(sum.ahead, sum.left) / sum.area, static_cast<int>(sum.area)});
    return booths;
}

/// The largest light that offers a task; nullptr: none.
const ColouredSpot* offer(const Sensors& sensors) {
    if (!sensors.spots) return nullptr;
    const auto found =
        std::find_if(sensors.spots->begin(), sensors.spots->end(),
                     [](const ColouredSpot& spot) { return spot.colour != ColouredSpot::Colour::Red; });
    return found == sensors.spots->end() ? nullptr : &*found;
}

}  // namespace

void Seek::enter(State state, double t) {
    if (state == State::Serve) {
        serve_ = Serve();
        edge_ = 0;
    }
    state_ = state;
    since_ = t;
}

Actuators Seek::approach(const Sensors& sensors, const Actuators& wandering, double t) {
    const ColouredSpot* light = offer(sensors);
    if (light == nullptr) {
        if (t - seen_ > kForget) enter(State::Search, t);
        return wandering;
    }
    if (light->distance_cm < kAtMouth && std::abs(light->bearing) < kAhead) {
        enter(State::Serve, t);
        return serve(sensors, t);
    }
    if (wander_.avoiding() && light->distance_cm > kBeside) return wandering;
    Actuators out = drive_towards(light->bearing, kSpeed);
    out.ring_leds = kFrontLeds;
    return out;
}

/// Until it has been inside and has backed out, or has found no way in.
Actuators Seek::serve(const Sensors& sensors, double t) {
    const Actuators out = serve_.step(sensors, t - since_);  // its time begins with it
    if (out.left_mm_s + out.right_mm_s >= 0) feel_edge();
    if (!serve_.pausing()) return out;
    visits_ += serve_.visits();
    enter(serve_.visits() > 0 ? State::Turn : State::Sidestep, t);
    return {};
}

void Seek::feel_edge() {
    const auto& felt = wander_.above_offset();
    const double right = std::max(felt[0], felt[1]), left = std::max(felt[7], felt[6]);
    if (std::max(right, left) > std::abs(edge_)) edge_ = right > left ? right : -left;
}

/// Away from the side that was in the way.
Actuators Seek::sidestep(double t) {
    const double spent = t - since_;
    if (spent > kAskew + kAside) enter(State::Search, t);
    if (spent > kAskew) return {.left_mm_s = kSpeed, .right_mm_s = kSpeed};
    const double turn = edge_ > 0 ? kTurnSpeed : -kTurnSpeed;
    return {.left_mm_s = -turn, .right_mm_s = turn};
}

Actuators Seek::step(const Sensors& seen, double t) {
    Sensors sensors = seen;
    if (sensors.spots) sensors.spots = joined(*sensors.spots);
    const Actuators wandering = wander_.step(sensors, t);
    if (offer(sensors) != nullptr) seen_ = t;
    Actuators out = wandering;
    switch (state_) {
    case State::Search:
        if (offer(sensors) != nullptr) enter(State::Approach, t);
        break;
    case State::Approach:
        out = approach(sensors, wandering, t);
        break;
    case State::Serve:
        out = serve(sensors, t);
        break;
    case State::Sidestep:
        out = sidestep(t);
        break;
    case State::Turn:
        out = {.left_mm_s = -kTurnSpeed, .right_mm_s = kTurnSpeed};
        if (t - since_ > kTurnAway) enter(State::Rest, t);
        break;
    case State::Rest:
        if (t - since_ > kRest) enter(State::Search, t);
        break;
    }
    out.body_led = out.body_led || !sensors.battery_ok;
    return out;
}

}  // namespace puckloop::control
