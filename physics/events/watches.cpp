#include "physics/events/watches.h"

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {

constexpr std::uint16_t kNoSignal = 0xFFFF;

/// Distance of two upright bodies, edge to edge, in plan; one of them is a robot and so a circle.
double gap(const Shape& circle, const Shape& other) {
    return -touch(other, circle.x, circle.y, circle.radius).depth;
}

}  // namespace

Watches::Watches(const EventPlan& plan, const Scene& scene) : plan_(plan), scene_(scene) {
    const auto& robots = scene.model().description().robots;
    for (const Robot& robot : robots)
        ways_.push_back({robot.x, robot.y, 0.0});
    for (std::size_t i = 0; i < plan.events.size(); ++i) {
        const auto& when = plan.events[i].when;
        if (!when || when->kind == Condition::Kind::After) continue;
        Watch watch{i, scene.find(when->robot).index, kNoSignal};
        // What is off or at rest from the start has to begin before it can end.
        watch.was = !when->on;
        const auto& ids = robots[watch.robot].board_signals;
        if (const auto id = ids.find(when->other); id != ids.end()) watch.signal = id->second;
        watches_.push_back(watch);
    }
}

void Watches::board_signal(std::size_t robot, std::uint16_t id, double value) {
    for (Watch& watch : watches_)
        if (watch.robot == robot && watch.signal == id) watch.lit = value != 0.0;
}

void Watches::bodies_moved() {
    for (std::size_t i = 0; i < ways_.size(); ++i) {
        const RobotState& now = scene_.model().state(i);
        if (!scene_.model().robot(i).lifted())
            ways_[i].length += std::hypot(now.x - ways_[i].x, now.y - ways_[i].y);
    }
}

bool Watches::holds(const Watch& watch) const {
    const Condition& when = *plan_.events[watch.event].when;
    const WorldModel& model = scene_.model();
    const RobotState& robot = model.state(watch.robot);
    switch (when.kind) {
    case Condition::Kind::Near: {
        const Found other = scene_.find(when.other);
        const bool solid = other.kind == Found::Kind::Robot || other.kind == Found::Kind::Fixed ||
                           other.kind == Found::Kind::Object;
        if (!solid || model.robot(watch.robot).lifted()) return false;
        if (other.kind == Found::Kind::Robot && model.robot(other.index).lifted()) return false;
        return gap(scene_.shape_of({Found::Kind::Robot, watch.robot}), scene_.shape_of(other)) <=
               when.distance;
    }
    case Condition::Kind::Enters: {
        const double dx = robot.x - when.at.x, dy = robot.y - when.at.y;
        if (model.robot(watch.robot).lifted()) return false;
        if (when.radius > 0.0) return std::hypot(dx, dy) <= when.radius;
        return std::abs(dx) <= when.length / 2 && std::abs(dy) <= when.width / 2;
    }
    case Condition::Kind::Travels:
        return ways_[watch.robot].length >= when.distance * static_cast<double>(watch.fired + 1);
    case Condition::Kind::Led:
        return watch.lit == when.on;
    case Condition::Kind::Wheels: {
        const auto& body = model.robot(watch.robot);
        const bool runs =
            body.drive(Side::Left).driven(model.seconds()) || body.drive(Side::Right).driven(model.seconds());
        return runs == when.on;
    }
    case Condition::Kind::After:
        break;
    }
    return false;
}

std::vector<std::size_t> Watches::come_true() {
    std::vector<std::size_t> events;
    for (Watch& watch : watches_) {
        const Event& event = plan_.events[watch.event];
        if (watch.fired == event.count) continue;
        const bool now = holds(watch);
        if (now && !watch.was) {
            events.push_back(watch.event);
            ++watch.fired;
        }
        watch.was = now && event.when->kind != Condition::Kind::Travels;
    }
    for (std::size_t i = 0; i < ways_.size(); ++i) {
        ways_[i].x = scene_.model().state(i).x;
        ways_[i].y = scene_.model().state(i).y;
    }
    return events;
}

}  // namespace puckloop::physics
