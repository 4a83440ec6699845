// Descriptions: refusals that name the element, parameters by name, JSON there and back.

#include "base/error.h"
#include "tests/physics/worlds.h"

#include <catch2/catch.hpp>

#include <functional>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;
using Catch::Matchers::Contains;

namespace {

std::string refusal(const std::function<void(World&)>& spoil) {
    World world = world_with_robot();
    world.file = "hello.toml";
    Box box{.name = "crate"};
    box.x = 0.5;
    box.place = "line 12";
    world.boxes.push_back(box);
    world.robots[0].place = "line 20";
    spoil(world);
    try {
        check(world);
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

}  // namespace

TEST_CASE("a good world is accepted, a bad one refused by name and place") {
    CHECK(refusal([](World&) {}) == "accepted");
    const auto negative = refusal([](World& w) { w.boxes[0].width = -0.1; });
    CHECK_THAT(negative, Contains("hello.toml") && Contains("line 12") && Contains("box 'crate'") &&
                             Contains("width = -0.1"));
    CHECK_THAT(refusal([](World& w) { w.robots[0].x = 5; }),
               Contains("robot 'e1'") && Contains("outside the arena") && Contains("line 20"));
    CHECK_THAT(refusal([](World& w) { w.robots[0].x = 0.98; }), Contains("wall"));
    CHECK_THAT(refusal([](World& w) { w.robots[0].x = 0.45; }), Contains("overlaps box 'crate'"));
    CHECK_THAT(refusal([](World& w) { w.robots.push_back(robot_at("e2", 0.05, 0)); }),
               Contains("robot 'e2'") && Contains("overlaps robot 'e1'"));
    CHECK_THAT(refusal([](World& w) { w.robots.push_back(robot_at("e1", 0.3, 0)); }),
               Contains("already taken"));
    CHECK_THAT(refusal([](World& w) { w.robots.push_back(robot_at("", 0.3, 0)); }), Contains("name"));
    CHECK_THAT(refusal([](World& w) { w.robots.push_back(robot_at("a,b", 0.3, 0)); }), Contains("comma"));
    CHECK_THAT(refusal([](World& w) { w.arena.corners.resize(2); }),
               Contains("arena") && Contains("2 corners"));
    CHECK_THAT(refusal([](World& w) { std::swap(w.arena.corners[1], w.arena.corners[2]); }),
               Contains("cross"));
    CHECK_THAT(refusal([](World& w) { w.ambient_light = std::nan(""); }), Contains("ambient_light"));
    CHECK_THAT(refusal([](World& w) { w.lamps.push_back({.name = "l", .intensity = -1}); }),
               Contains("lamp 'l'") && Contains("intensity"));
    CHECK_THAT(refusal([](World& w) { w.patches.push_back({.name = "p", .grey = 1.5}); }), Contains("grey"));
    CHECK_THAT(
        refusal([](World& w) { w.cylinders.push_back({.name = "c", .x = 0.3, .movable = true, .mass = 0}); }),
        Contains("cylinder 'c'") && Contains("mass"));
    CHECK_THAT(refusal([](World& w) { w.recording.period = 0.0005; }), Contains("period"));
}

TEST_CASE("a fixed thing that no part of the arena reaches is refused, one that reaches into it is not") {
    const auto box = [](double x, double y, double heading, double length, double width) {
        return refusal([=](World& w) {
            Box other{.name = "other"};
            other.x = x;
            other.y = y;
            other.heading = heading;
            other.length = length;
            other.width = width;
            w.boxes.push_back(other);
        });
    };
    const auto cylinder = [](double x, double y, double radius) {
        return refusal(
            [=](World& w) { w.cylinders.push_back({.name = "can", .x = x, .y = y, .radius = radius}); });
    };
    // The arena is 2 m by 2 m about the origin.
    CHECK_THAT(box(3, 0, 0, 0.1, 0.1), Contains("box 'other': (3 m, 0 m) is outside the arena"));
    CHECK_THAT(box(1.2, 1.2, 0.785, 0.1, 0.5), Contains("outside the arena"));
    CHECK(box(1.2, 1.2, 0.785, 0.6, 0.1) == "accepted");  // its corner is within
    CHECK(box(1.2, 0.8, 0, 0.5, 0.1) == "accepted");      // its end
    CHECK(box(0, 1.1, 0, 4, 0.3) == "accepted");          // its side, beyond both corners
    CHECK_THAT(cylinder(0, -1.3, 0.25), Contains("cylinder 'can'") && Contains("outside the arena"));
    CHECK(cylinder(0, -1.3, 0.35) == "accepted");
}

TEST_CASE("parameters: unknown names, ranges, and what a robot may override") {
    CHECK_THAT(refusal([](World& w) { w.parameters["robot.axle_lenght"] = 0.05; }),
               Contains("did you mean \"robot.axle_length\""));
    CHECK_THAT(refusal([](World& w) { w.robots[0].parameters["robot.axle_length"] = 1; }),
               Contains("robot 'e1'") && Contains("out of range") && Contains("0.045 to 0.06 m"));
    CHECK_THAT(refusal([](World& w) { w.robots[0].parameters["contact.mu"] = 0.5; }),
               Contains("whole world"));
    Parameters p;
    p.set("proximity.gain3", 2);
    CHECK(p.get("proximity.gain3") == 2);
    CHECK(p.get("proximity.gain4") == 1);
    p.set("proximity.gain", 0.5);
    CHECK(p.get("proximity.gain7") == 0.5);
    CHECK_THROWS(p.set("proximity.gain8", 1));
    CHECK_THROWS(p.set("ground.gain3", 1));
    for (const auto& info : parameter_table())
        for (const double value : info.defaults) {
            INFO(info.name);
            CHECK(value >= info.min);
            CHECK(value <= info.max);
            CHECK(
                (info.defaults.size() == 1 || info.defaults.size() == static_cast<std::size_t>(info.count)));
        }
}

TEST_CASE("no two parameters share a place, and every number is in the table") {
    Parameters p;
    std::size_t values = 0;
    double serial = 1e6;
    for (const auto& info : parameter_table())
        for (int i = 0; i < info.count; ++i, ++values)
            info.place(p)[i] = serial++;
    serial = 1e6;
    for (const auto& info : parameter_table())
        for (int i = 0; i < info.count; ++i)
            CHECK(info.place(p)[i] == serial++);
    CHECK(values * sizeof(double) == sizeof(Parameters));
}

TEST_CASE("a description survives JSON to the last bit") {
    World world = world_with_robot(1.1, 0.7);
    world.seed = 18446744073709551557ULL;
    world.robots[0].heading = 0.1 + 0.2;
    world.robots[0].parameters["robot.mass"] = 0.123456789012345678;
    world.robots[0].board_signals = {{"wheel_left", 42}, {"proximity0", 0}};
    world.patches.push_back({.name = "p", .shape = Patch::Shape::Disc});
    const std::string text = to_json(world);
    const World back = from_json(text);
    CHECK(to_json(back) == text);
    CHECK(back.robots[0].heading == world.robots[0].heading);
    CHECK(back.seed == world.seed);
    CHECK(back.patches[0].shape == Patch::Shape::Disc);
    CHECK_THROWS_AS(from_json("{\"node_name\": 3}"), InputError);
    CHECK_THROWS_AS(from_json("nonsense"), InputError);
}
