#pragma once
// Random worlds and random hands, for tests that hold one way of working something out to another.

#include "base/error.h"
#include "base/random.h"
#include "physics/events/scene.h"
#include "tests/physics/worlds.h"

#include <numbers>

namespace puckloop::physics::test {

inline double between(RandomStream& chance, double low, double high) {
    return low + (high - low) * chance.uniform();
}

inline bool possible(const World& world) {
    try {
        check(world);
        return true;
    } catch (const InputError&) {
        return false;
    }
}

/// Adds up to `count` things that `make(index)` gives; those that do not fit are left out.
template <class Things, class Make>
void add_things(World& world, Things& things, int count, Make make) {
    for (int i = 0; i < count; ++i) {
        things.push_back(make(std::to_string(i)));
        if (!possible(world)) things.pop_back();
    }
}

/// A room of about a metre and a half with some of everything and `robots` robots at most, near each other.
inline World random_world(RandomStream& chance, int robots) {
    World world;
    world.seed = chance.next() % 1000;
    world.arena = rectangular_arena(between(chance, 0.7, 1.6), between(chance, 0.7, 1.6));
    world.arena.floor_grey = chance.uniform();
    world.ambient_light = between(chance, 0, 3);
    const auto place = [&] { return between(chance, -0.7, 0.7); };
    const auto turn = [&] { return between(chance, -3.1, 3.1); };
    add_things(world, world.walls, 2, [&](const std::string& name) {
        const double x = place(), y = place();
        return Wall{.name = "wall" + name, .from = {x, y}, .to = {x + between(chance, -.3, .3), y + 0.2}};
    });
    add_things(world, world.boxes, 4, [&](const std::string& name) {
        return Box{.name = "box" + name,
                   .x = place(),
                   .y = place(),
                   .heading = turn(),
                   .length = 0.1,
                   .width = between(chance, .03, .2),
                   .height = between(chance, .02, .1),
                   .movable = chance.below(2) == 0,
                   .mass = 0.02,
                   .reflectivity = chance.uniform()};
    });
    add_things(world, world.cylinders, 4, [&](const std::string& name) {
        return Cylinder{.name = "can" + name,
                        .x = place(),
                        .y = place(),
                        .radius = between(chance, .01, .08),
                        .height = between(chance, .02, .1),
                        .movable = chance.below(2) == 0,
                        .mass = 0.02};
    });
    add_things(world, world.lamps, static_cast<int>(chance.below(3)), [&](const std::string& name) {
        return Lamp{.name = "lamp" + name,
                    .x = place(),
                    .y = place(),
                    .height = between(chance, .02, .4),
                    .intensity = chance.uniform()};
    });
    add_things(world, world.patches, static_cast<int>(2 + chance.below(4)), [&](const std::string& name) {
        const auto shape = chance.below(2) == 0 ? Patch::Shape::Disc : Patch::Shape::Rectangle;
        return Patch{.name = "patch" + name,
                     .shape = shape,
                     .x = place(),
                     .y = place(),
                     .heading = turn(),
                     .length = 0.2,
                     .width = between(chance, .05, .3),
                     .radius = 0.1,
                     .grey = chance.uniform()};
    });
    add_things(world, world.robots, robots,
               [&](const std::string& name) { return robot_at("e" + name, place(), place(), turn()); });
    // Virtual things may be anywhere; every other one is sensed by the first robot alone.
    const auto who = [&](int i) {
        return i % 2 == 0 || world.robots.empty() ? std::vector<std::string>{}
                                                  : std::vector<std::string>{world.robots[0].name};
    };
    for (int i = 0; i < 2; ++i) {
        Virtual<Box> box;
        static_cast<Box&>(box) = {.name = "ghost" + std::to_string(i),
                                  .x = place(),
                                  .y = place(),
                                  .heading = turn(),
                                  .length = 0.1,
                                  .width = between(chance, .03, .2)};
        box.robots = who(i);
        world.virtuals.boxes.push_back(box);
        Virtual<Lamp> lamp;
        static_cast<Lamp&>(lamp) = {.name = "glow" + std::to_string(i),
                                    .x = place(),
                                    .y = place(),
                                    .height = between(chance, .02, .4),
                                    .intensity = chance.uniform()};
        lamp.robots = who(i + 1);
        world.virtuals.lamps.push_back(lamp);
    }
    return world;
}

/// Something that hands may do; it may well be refused.
inline Action random_action(RandomStream& chance, const World& world) {
    constexpr Verb kVerbs[] = {Verb::Move,     Verb::Remove, Verb::Lift, Verb::Put,  Verb::SwitchOff,
                               Verb::SwitchOn, Verb::Set,    Verb::Move, Verb::Unset};
    std::vector<std::string> names{std::string(kFloor), std::string(kRoomLight)};
    const auto note = [&](const auto& things) {
        for (const auto& thing : things)
            names.push_back(thing.name);
    };
    note(world.walls);
    note(world.boxes);
    note(world.cylinders);
    note(world.lamps);
    note(world.patches);
    note(world.virtuals.boxes);
    note(world.virtuals.lamps);
    note(world.robots);
    Action action;
    action.verb = kVerbs[chance.below(std::size(kVerbs))];
    action.object = names[chance.below(names.size())];
    if (action.verb == Verb::Remove && chance.below(4) != 0) action.verb = Verb::Move;
    if (action.verb == Verb::Move || action.verb == Verb::Put) {
        action.to = Point{between(chance, -.6, .6), between(chance, -.6, .6)};
        if (chance.below(2) == 0) action.heading = between(chance, -3, 3);
        if (action.verb == Verb::Move && chance.below(2) == 0) action.over = between(chance, .01, .1);
    }
    if (action.verb == Verb::Set) {
        constexpr const char* kProperties[] = {"grey",         "ambient", "intensity",
                                               "reflectivity", "charge",  "ground"};
        action.property = kProperties[chance.below(std::size(kProperties))];
        if (chance.below(2) == 0) {
            action.object = kRoomLight;
            action.property = "ambient";
        }
        action.value = chance.uniform();
    }
    return action;
}

/// Drives every robot by speeds that it changes now and then.
class Herd {
  public:
    Herd(WorldModel& model, std::uint64_t seed) : chance_(seed, "herd"), speeds_(model.robot_count()) {
        for (std::size_t i = 0; i < speeds_.size(); ++i)
            drivers_.emplace_back(model, i);
    }
    void feed() {
        for (std::size_t i = 0; i < speeds_.size(); ++i) {
            if (chance_.below(150) == 0)
                for (double& speed : speeds_[i])
                    speed = chance_.below(4) == 0 ? 0.0 : between(chance_, -1000, 1000);
            drivers_[i].feed(speeds_[i][0], speeds_[i][1]);
        }
    }

  private:
    RandomStream chance_;
    std::vector<std::array<double, 2>> speeds_;
    std::vector<Driver> drivers_;
};

}  // namespace puckloop::physics::test
