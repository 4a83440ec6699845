#include "physics/events/scene.h"

#include "base/error.h"
#include "physics/events/new_thing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {

using Kind = Found::Kind;

/// A world with the new thing and nothing else: check() judges sizes and values.
std::string problem_of_thing(const NewThing& thing, const World& like) {
    World world = world_of(thing, like.arena);
    world.arena.place = {};
    for_each_thing(world, [](auto& one, const char*) { one.place.clear(); });
    try {
        check_things(world);
        check_who_senses(world.virtuals, like.robots, {});
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

template <class Things, class Thing>
void append(Things& to, const std::vector<Thing>& from) {
    to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

Scene::Scene(WorldModel& model)
    : model_(model),
      arena_walls_(arena_walls(model.description().arena).size()),
      built_in_(built_in_count(model.description())) {
    for (std::size_t i = 0; i < model.description().walls.size(); ++i)
        walls_.insert(built_in_ + i);
}

std::string Scene::apply(const Action& action) {
    if (std::string problem = problem_of(action); !problem.empty()) return problem;
    if (action.verb == Verb::Add) return add(action);
    const Found what = find(action.object);
    if (action.verb == Verb::Set && !what) return set_room(action);
    if (!what) return unknown(action.object);
    switch (action.verb) {
    case Verb::Move:
        return move(action, what);
    case Verb::Remove:
        return remove(action, what);
    case Verb::Lift:
        return lift(action, what);
    case Verb::Put:
        return put(action, what);
    case Verb::Set:
        return set(action, what);
    case Verb::SwitchOff:
    case Verb::SwitchOn:
        return switch_over(action, what);
    case Verb::Unset:
        return unset(action, what);
    case Verb::Tune:
        return tune(action, what);
    default:
        return fmt::format("nothing of '{}' happens in the world", action.command);
    }
}

std::string Scene::move(const Action& action, Found what) {
    const Pose now = pose_of(what);
    Pose target = now;
    if (action.to) {
        target.x = action.to->x + (action.relative ? now.x : 0.0);
        target.y = action.to->y + (action.relative ? now.y : 0.0);
    }
    if (action.heading) target.heading = *action.heading;
    const bool robot = what.kind == Kind::Robot;
    const bool carried = std::any_of(glides_.begin(), glides_.end(), [&](const Glide& glide) {
        return glide.name == action.object && !glide.stays_lifted;
    });
    const bool stays_lifted = robot && model_.robot(what.index).lifted() && !carried;
    if (!stays_lifted)
        if (std::string problem = obstacle(what, target); !problem.empty()) return problem;
    stop_gliding(action.object);
    const auto steps = static_cast<std::uint64_t>(std::llround(action.over / kStepSeconds));
    if (steps == 0) {
        place(what, target);
        return {};
    }
    if (robot) set_lifted(what.index, true);
    glides_.push_back({action.object, now, target, steps, 0, stays_lifted});
    return {};
}

void Scene::glide() {
    for (Glide& glide : glides_) {
        const Found what = find(glide.name);
        const bool last = ++glide.done >= glide.steps;
        const double share = static_cast<double>(glide.done) / static_cast<double>(glide.steps);
        const double seconds = static_cast<double>(glide.steps) * kStepSeconds;
        const double dx = glide.to.x - glide.from.x, dy = glide.to.y - glide.from.y;
        if (last)
            place(what, glide.to);
        else
            place(what,
                  {glide.from.x + share * dx, glide.from.y + share * dy,
                   glide.from.heading + share * (glide.to.heading - glide.from.heading)},
                  dx / seconds, dy / seconds);
        if (last && what.kind == Kind::Robot && !glide.stays_lifted) set_lifted(what.index, false);
    }
    std::erase_if(glides_, [](const Glide& glide) { return glide.done >= glide.steps; });
}

/// A robot whose way is cut short is put down where it is.
void Scene::stop_gliding(std::string_view name) {
    const auto found =
        std::find_if(glides_.begin(), glides_.end(), [&](const Glide& glide) { return glide.name == name; });
    if (found == glides_.end()) return;
    if (const Found what = find(name); what.kind == Kind::Robot && !found->stays_lifted)
        set_lifted(what.index, false);
    glides_.erase(found);
}

template <class Thing>
std::string Scene::add_body(const Thing& thing, double heading) {
    const Shape shape = physics::shape_of(thing);
    if (std::string problem = obstacle(shape, {}, false); !problem.empty()) return problem;
    if (thing.movable) {
        model_.add_object(shape, thing.name, heading, thing.mass);
        return {};
    }
    add_fixed(shape, thing.name);
    return {};
}

void Scene::add_fixed(const Shape& shape, const std::string& name) {
    model_.fixed_by_hand_.insert(model_.fixed_.size());
    model_.fixed_.push_back(shape);
    model_.fixed_names_.push_back(name);
    model_.dynamics_.add_fixed(shape);
}

std::string Scene::add(const Action& action) {
    const NewThing& thing = action.thing;
    World& world = model_.description_;
    if (std::string problem = problem_of_thing(thing, world); !problem.empty()) return problem;
    constexpr std::size_t kMost = 4000;  // ids of their signals to the infra-red medium are sixteen bits
    if (model_.fixed_count() + model_.object_names().size() > kMost) return "there are too many things";
    if (find(action.object)) return fmt::format("there already is a '{}'", action.object);
    std::string problem;
    for (const Wall& wall : thing.walls) {
        const Shape shape = physics::shape_of(wall);
        if (problem = obstacle(shape, {}, true); !problem.empty()) return problem;
        walls_.insert(model_.fixed_.size());
        add_fixed(shape, wall.name);
    }
    for (const Box& box : thing.boxes)
        problem = add_body(box, box.heading);
    for (const Cylinder& cylinder : thing.cylinders)
        problem = add_body(cylinder, 0.0);
    if (!problem.empty()) return problem;
    append(world.lamps, thing.lamps);
    append(world.speakers, thing.speakers);
    append(world.patches, thing.patches);
    for (VirtualBody& body : virtual_bodies(thing.virtuals)) {
        body.by_hand = true;
        model_.virtual_bodies_.push_back(std::move(body));
    }
    append(world.virtuals.lamps, thing.virtuals.lamps);
    scene_changed();
    return {};
}

std::string Scene::remove(const Action& action, Found what) {
    World& world = model_.description_;
    const auto at = [&](auto& things) { return things.begin() + static_cast<std::ptrdiff_t>(what.index); };
    stop_gliding(action.object);
    was_on_.erase(action.object);
    switch (what.kind) {
    case Kind::Fixed:
        model_.fixed_[what.index].height = 0.0;
        model_.dynamics_.remove_fixed(what.index);
        break;
    case Kind::Object:
        model_.moving_[model_.robot_count() + what.index].shape.height = 0.0;
        model_.dynamics_.remove_object(what.index);
        break;
    case Kind::Lamp:
        world.lamps.erase(at(world.lamps));
        break;
    case Kind::Speaker:
        world.speakers.erase(at(world.speakers));
        break;
    case Kind::Patch:
        world.patches.erase(at(world.patches));
        break;
    case Kind::VirtualBody:
        model_.virtual_bodies_.erase(at(model_.virtual_bodies_));
        break;
    case Kind::VirtualLamp:
        world.virtuals.lamps.erase(at(world.virtuals.lamps));
        break;
    case Kind::VirtualBoard:
        return fmt::format("'{}' is a virtual board, which stays in the run", action.object);
    default:
        return fmt::format("'{}' is a robot, which stays in the run (expected lift, or a thing)",
                           action.object);
    }
    scene_changed();
    return {};
}

std::string Scene::lift(const Action& action, Found what) {
    if (what.kind != Kind::Robot) return fmt::format("'{}' is no robot", action.object);
    stop_gliding(action.object);
    if (model_.robot(what.index).lifted()) return fmt::format("'{}' is in the air already", action.object);
    set_lifted(what.index, true);
    return {};
}

std::string Scene::put(const Action& action, Found what) {
    if (what.kind != Kind::Robot) return fmt::format("'{}' is no robot", action.object);
    if (!model_.robot(what.index).lifted())
        return fmt::format("'{}' has not been lifted (expected lift before, or move)", action.object);
    Pose pose = pose_of(what);
    if (action.to) pose = {action.to->x, action.to->y, pose.heading};
    if (action.heading) pose.heading = *action.heading;
    if (std::string problem = obstacle(what, pose); !problem.empty()) return problem;
    std::erase_if(glides_, [&](const Glide& glide) { return glide.name == action.object; });
    place(what, pose);
    set_lifted(what.index, false);
    return {};
}

std::string Scene::set_room(const Action& action) {
    World& world = model_.description_;
    if (action.object == kFloor && action.property == "grey")
        world.arena.floor_grey = action.value;
    else if (action.object == kRoomLight && action.property == "ambient")
        world.ambient_light = action.value;
    else if (action.object == kFloor || action.object == kRoomLight)
        return fmt::format("the {} has no {} (expected {})", action.object, action.property,
                           action.object == kFloor ? "grey" : "ambient");
    else
        return unknown(action.object);
    scene_changed();
    return {};
}

std::string Scene::set(const Action& action, Found what) {
    World& world = model_.description_;
    const std::string& property = action.property;
    if (what.kind == Kind::Robot && property == "charge") {
        model_.robots_[what.index].set_charge(action.value);
        return {};
    }
    if (what.kind == Kind::Robot && property == "ground") {
        model_.robots_[what.index].set_felt_ground(action.value);
        scene_changed();
        return {};
    }
    double* value = nullptr;
    if (what.kind == Kind::Lamp && property == "intensity") value = &world.lamps[what.index].intensity;
    if (what.kind == Kind::VirtualLamp && property == "intensity")
        value = &world.virtuals.lamps[what.index].intensity;
    if (what.kind == Kind::Speaker && property == "level") value = &world.speakers[what.index].level;
    if (what.kind == Kind::Patch && property == "grey" && world.patches[what.index].image.empty())
        value = &world.patches[what.index].grey;
    if (property == "reflectivity") {
        if (what.kind == Kind::Fixed) value = &model_.fixed_[what.index].reflectivity;
        if (what.kind == Kind::VirtualBody) value = &model_.virtual_bodies_[what.index].shape.reflectivity;
        if (what.kind == Kind::Object)
            value = &model_.moving_[model_.robot_count() + what.index].shape.reflectivity;
    }
    if (value == nullptr) return fmt::format("'{}' has no {}", action.object, property);
    *value = action.value;
    was_on_.erase(action.object);
    scene_changed();
    return {};
}

std::string Scene::unset(const Action& action, Found what) {
    if (what.kind != Kind::Robot) return fmt::format("'{}' is no robot", action.object);
    if (!model_.robot(what.index).felt_ground())
        return fmt::format("'{}' sees the floor as it is (expected set {} ground GREY before)", action.object,
                           action.object);
    model_.robots_[what.index].set_felt_ground(std::nullopt);
    scene_changed();
    return {};
}

std::string Scene::tune(const Action& action, Found what) {
    if (what.kind != Kind::Robot) return fmt::format("'{}' is no robot", action.object);
    model_.robots_[what.index].tune(action.property, action.value, model_.description_);
    scene_changed();
    return {};
}

std::string Scene::switch_over(const Action& action, Found what) {
    World& world = model_.description_;
    if (what.kind != Kind::Lamp && what.kind != Kind::VirtualLamp && what.kind != Kind::Speaker)
        return fmt::format("'{}' has no switch (expected a lamp or a speaker)", action.object);
    double& value = what.kind == Kind::Lamp          ? world.lamps[what.index].intensity
                    : what.kind == Kind::VirtualLamp ? world.virtuals.lamps[what.index].intensity
                                                     : world.speakers[what.index].level;
    const auto before = was_on_.find(action.object);
    const bool off = before != was_on_.end();
    if (action.verb == Verb::SwitchOff) {
        if (off) return fmt::format("'{}' is off already", action.object);
        was_on_[action.object] = value;
        value = 0.0;
    } else {
        if (!off) return fmt::format("'{}' is on already", action.object);
        value = before->second;
        was_on_.erase(before);
    }
    scene_changed();
    return {};
}

}  // namespace puckloop::physics
