#include "linuxboard/control/behaviours/seek.h"

#include "linuxboard/control/behaviours/booth_lights.h"
#include "linuxboard/control/behaviours/steering.h"

#include <algorithm>
#include <cmath>

namespace puckloop::control {

namespace {

constexpr double kSpeed = 60.0;       // mm/s, towards the light
constexpr double kBeside = 22.0;      // cm: nearer than that the booth's sides are no obstacles
constexpr double kAtMouth = 17.0;     // cm, from its lights: about to drive in
constexpr double kAhead = 0.25;       // rad: it is straight ahead
constexpr double kOnAxis = 0.6;       // of the way to the lights: it aims at their axis there
constexpr double kAxisSettle = 0.25;  // share of a new look in what is known of the axis
constexpr double kTellApart =
    28.0;                         // cm: nearer than that, a single light is one whose neighbours a side hides
constexpr double kInLine = 0.3;   // rad: more aside at the mouth, it would meet a side
constexpr double kRetreat = 2.0;  // s, backwards: 12 cm
constexpr double kBehind = 120.0;      // counts: something 5 cm behind
constexpr double kTurnSpread = 0.25;   // s: along walls it is not to turn round
constexpr double kFar = 60.0;          // cm: a single pixel may be a light, or nothing
constexpr double kLinger = 8.0;        // s in the dark behind a task, before a booth offers another
constexpr double kLongestWait = 25.0;  // s
constexpr double kBoothForget = 1.5;   // s without seeing it
constexpr double kTurnAway = 2.1;      // s: half a turn
constexpr double kTurnSpeed = 40.0;    // mm/s
constexpr double kAskew = 0.8;         // s of turning aside: some 70 degrees
constexpr double kAside = 1.8;         // s of driving there: 11 cm
constexpr double kRest = 8.0;          // s in which no booth is looked for
constexpr std::uint8_t kFrontLeds = 0x83;

/// The booth with the largest lights that offers a task; nullptr: none.
const BoothLights* offer(const std::vector<BoothLights>& booths) {
    const auto found = std::find_if(booths.begin(), booths.end(), [](const BoothLights& booth) {
        return booth.middle.colour != ColouredSpot::Colour::Red;
    });
    return found == booths.end() ? nullptr : &*found;
}

}  // namespace

Seek::Seek() : wander_(kTurnSpread) {}

void Seek::enter(State state, double t) {
    if (state == State::Serve) {
        serve_ = Serve();
        edge_ = 0;
    }
    state_ = state;
    since_ = t;
}

Actuators Seek::approach(const BoothLights* booth, const Sensors& sensors, const Actuators& wandering,
                         double t) {
    if (booth == nullptr) {
        if (guessing_) return wrong_guess(t);
        if (t - seen_ > kBoothForget) enter(State::Search, t);
        return wandering;
    }
    const ColouredSpot& lights = booth->middle;
    guessing_ = !known_ && lights.distance_cm < kTellApart;
    if (lights.distance_cm < kAtMouth && std::abs(lights.bearing) < kAhead) {
        if (guessing_) return wrong_guess(t);
        enter(std::abs(askew_) < kInLine ? State::Serve : State::Retreat, t);
        return state_ == State::Serve ? serve(sensors, t) : Actuators{};
    }
    if (wander_.avoiding() && lights.distance_cm > kBeside) return wandering;
    const double ahead = lights.distance_cm < kAtMouth ? 0.0 : kOnAxis;
    Actuators out = drive_towards(bearing_of_axis(lights, guessing_ ? guess_ : askew_, ahead), kSpeed);
    out.ring_leds = kFrontLeds;
    return out;
}

/// Until it has been inside and has backed out, or has found no way in.
Actuators Seek::serve(const Sensors& sensors, double t) {
    const Actuators out = serve_.step(sensors, t - since_);  // its time begins with it
    if (out.left_mm_s + out.right_mm_s >= 0) feel_edge();
    if (serve_.waiting() && t - seen_ > kBoothForget) enter(State::Retreat, t);  // out of another's way
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

/// The axis seems to be on the other side.
Actuators Seek::wrong_guess(double t) {
    guess_ = -guess_;
    guessing_ = false;
    enter(State::Retreat, t);
    return {};
}

/// Straight back, to come again with more room to get into line.
Actuators Seek::retreat(double t) {
    const auto& felt = wander_.above_offset();
    if (t - since_ > kRetreat || std::max(felt[3], felt[4]) > kBehind) enter(State::Approach, t);
    return {.left_mm_s = -kSpeed, .right_mm_s = -kSpeed};
}

/// What is known of the booth's axis.
void Seek::look(const BoothLights& booth, double t) {
    if (t - seen_ > kBoothForget && state_ == State::Search) known_ = false;
    seen_ = t;
    if (!booth.askew) return;
    askew_ = known_ ? askew_ + kAxisSettle * (*booth.askew - askew_) : *booth.askew;
    known_ = true;
}

/// Before a booth in which somebody works it waits for a while: it will offer something again.
bool Seek::waits(const std::vector<BoothLights>& booths, double t) {
    const bool busy = std::any_of(booths.begin(), booths.end(), [](const BoothLights& booth) {
        return booth.middle.distance_cm > kBeside && booth.middle.distance_cm < kFar;
    });
    if (t - busy_seen_ > kLinger) waiting_since_ = t;
    if (busy) busy_seen_ = t;
    return t - busy_seen_ < kLinger && t - waiting_since_ < kLongestWait;
}

Actuators Seek::step(const Sensors& seen, double t) {
    Sensors sensors = seen;
    const std::vector<BoothLights> booths = booths_of(seen.spots.value_or(std::vector<ColouredSpot>{}));
    const BoothLights* booth = offer(booths);
    if (sensors.spots) {
        sensors.spots->clear();
        for (const BoothLights& each : booths)
            sensors.spots->push_back(each.middle);
    }
    const Actuators wandering = wander_.step(sensors, t);
    if (booth != nullptr) look(*booth, t);
    Actuators out = wandering;
    switch (state_) {
    case State::Search:
        if (booth != nullptr)
            enter(State::Approach, t);
        else if (waits(booths, t) && !wander_.avoiding())
            out = {};
        break;
    case State::Approach:
        out = approach(booth, sensors, wandering, t);
        break;
    case State::Retreat:
        out = retreat(t);
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
