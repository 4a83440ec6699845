#include "linuxboard/control/behaviours/machine.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace puckloop::control {

namespace {

constexpr double kFullSpeed = 120;     // mm/s
constexpr double kContact = 4095;      // counts of proximity that are 1
constexpr double kObstacle = 0.1;      // length of the proximity vector from which a walk turns
constexpr double kPush = 5;            // weight of obstacles
constexpr double kNoDirection = 0.1;   // a shorter vector is none: straight on
constexpr double kLightContrast = 20;  // counts between brightest and darkest: less is no direction
// Half way between what the ground sensors give over paper of 0, 50 and 100 %: some 327, 640 and 953.
constexpr double kBlack = 480, kWhite = 800;
constexpr double kCentimetres = 100;  // in a metre

/// Straight towards a direction: the wheel on its side turns slower, backwards if it lies behind.
Actuators towards(double x, double y) {
    if (std::hypot(x, y) < kNoDirection) return {.left_mm_s = kFullSpeed, .right_mm_s = kFullSpeed};
    const double slow = kFullSpeed * std::cos(std::atan2(y, x));
    if (y > 0) return {.left_mm_s = slow, .right_mm_s = kFullSpeed};
    return {.left_mm_s = kFullSpeed, .right_mm_s = slow};
}

double median(const std::array<double, 3>& values) {
    return std::max(std::min(values[0], values[1]), std::min(std::max(values[0], values[1]), values[2]));
}

}  // namespace

StateMachine::StateMachine(std::vector<MachineState> states, std::uint32_t seed)
    : states_(std::move(states)), random_(seed) {}

double StateMachine::draw() {
    return static_cast<double>(random_()) / 4294967296.0;
}

StateMachine::Vector StateMachine::obstacles(const Sensors& sensors) {
    const std::array<double, 8> above = baseline_.above_offset(sensors.proximity);
    Vector sum;
    for (std::size_t i = 0; i < above.size(); ++i) {
        const double share = std::min(1.0, above[i] / kContact);
        sum.x += share * std::cos(kRingBearing[i]);
        sum.y += share * std::sin(kRingBearing[i]);
    }
    return sum;
}

/// Of length 1, or 0 where no direction is brighter.
StateMachine::Vector StateMachine::light(const Sensors& sensors) {
    const auto [darkest, brightest] = std::minmax_element(sensors.light.begin(), sensors.light.end());
    if (*brightest - *darkest < kLightContrast) return {};
    Vector sum;
    for (std::size_t i = 0; i < sensors.light.size(); ++i) {
        sum.x += (sensors.light[i] - *darkest) * std::cos(kRingBearing[i]);
        sum.y += (sensors.light[i] - *darkest) * std::sin(kRingBearing[i]);
    }
    const double length = std::hypot(sum.x, sum.y);
    return length > 0 ? Vector{sum.x / length, sum.y / length} : Vector{};
}

/// Each neighbour pulls with weight / (1 + range in metres).
StateMachine::Vector StateMachine::neighbours(const Sensors& sensors, double weight) {
    Vector sum;
    for (const Neighbour& one : sensors.neighbours) {
        const double pull = weight / (1 + std::max(0.0, one.range_cm) / kCentimetres);
        sum.x += pull * std::cos(one.bearing);
        sum.y += pull * std::sin(one.bearing);
    }
    return sum;
}

/// Straight on; at an obstacle ahead turns away from it for a drawn number of steps.
Actuators StateMachine::walk(const Vector& obstacle, double longest) {
    if (turn_steps_ == 0 && obstacle.x >= 0 && std::hypot(obstacle.x, obstacle.y) >= kObstacle) {
        turn_steps_ = 1 + static_cast<int>(std::floor(draw() * longest));
        turn_side_ = obstacle.y < 0 ? 1 : -1;
    }
    if (turn_steps_ == 0) return {.left_mm_s = kFullSpeed, .right_mm_s = kFullSpeed};
    --turn_steps_;
    return {.left_mm_s = -turn_side_ * kFullSpeed, .right_mm_s = turn_side_ * kFullSpeed};
}

bool StateMachine::holds(const MachineCondition& condition, const Sensors& sensors) {
    using Kind = MachineCondition::Kind;
    const double drawn = draw();  // in any case: the sequence does not depend on what is seen
    if (condition.kind == Kind::Chance) return drawn < condition.p;
    if (condition.kind == Kind::Neighbours || condition.kind == Kind::FewNeighbours) {
        const auto count = static_cast<double>(sensors.neighbours.size());
        const double many = 1 / (1 + std::exp(condition.w * (condition.p - count)));
        return drawn < (condition.kind == Kind::Neighbours ? many : 1 - many);
    }
    if (!sensors.ground) return false;
    const double floor = median(*sensors.ground);
    const Kind seen = floor < kBlack ? Kind::Black : floor > kWhite ? Kind::White : Kind::Grey;
    return seen == condition.kind && drawn < condition.p;
}

/// Conditions are tried in a drawn order; the first that holds decides.
void StateMachine::leave(const Sensors& sensors) {
    std::vector<MachineCondition>& conditions = states_[static_cast<std::size_t>(state_)].conditions;
    for (std::size_t i = conditions.size(); i > 1; --i)
        std::swap(conditions[i - 1], conditions[static_cast<std::size_t>(draw() * static_cast<double>(i))]);
    for (const MachineCondition& condition : conditions) {
        if (!holds(condition, sensors)) continue;
        state_ = condition.target;
        fresh_ = true;
        turn_steps_ = 0;
        return;
    }
}

Actuators StateMachine::step(const Sensors& sensors, double) {
    using Kind = MachineState::Kind;
    const MachineState& state = states_[static_cast<std::size_t>(state_)];
    const Vector obstacle = obstacles(sensors);
    const auto away = [&](const Vector& wanted) {
        return towards(wanted.x - kPush * obstacle.x, wanted.y - kPush * obstacle.y);
    };
    Actuators out;
    if (state.kind == Kind::Walk) out = walk(obstacle, state.parameter);
    if (state.kind == Kind::ToLight || state.kind == Kind::FromLight) {
        const Vector seen = light(sensors);
        out = away(state.kind == Kind::ToLight ? seen : Vector{-seen.x, -seen.y});
    }
    if (state.kind == Kind::Attraction || state.kind == Kind::Repulsion) {
        const Vector pull = neighbours(sensors, state.parameter);
        out = away(state.kind == Kind::Attraction ? pull : Vector{-pull.x, -pull.y});
    }
    out.ring_leds = static_cast<std::uint8_t>(1U << (state_ % 8));
    out.body_led = !sensors.battery_ok;
    if (!std::exchange(fresh_, false)) leave(sensors);
    return out;
}

}  // namespace puckloop::control
