// A physical parameter that changes while the world is on: from then on as if it had been so from the start.

#include "physics/events/scene.h"
#include "physics/robot/tuning.h"
#include "tests/physics/events/plans.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

/// A wall that the robot's front looks at, half of a dark patch under it, a lamp.
World tuned_room() {
    World world = world_with_robot(1.0, 1.0);
    world.boxes.push_back({.name = "crate", .x = 0.11, .y = 0.01, .length = 0.1, .width = 0.3});
    world.patches.push_back(
        {.name = "dark", .x = 0.03, .y = -0.05, .length = 0.1, .width = 0.1, .grey = 0.2});
    world.lamps.push_back({.name = "sun", .x = 0.3, .y = -0.2});
    world.ambient_light = 0.3;
    return world;
}

void wait(WorldModel& model, int steps) {
    for (int i = 0; i < steps; ++i) {
        model.move_bodies();
        model.sense();
    }
}

/// Draws, or remembers more than a second.
bool goes_by_chance(std::string_view name) {
    constexpr std::array<std::string_view, 6> kParts{"noise",   "interference", "vibration",
                                                     "flicker", "warmup",       "period"};
    return std::any_of(kParts.begin(), kParts.end(),
                       [&](std::string_view part) { return name.find(part) != std::string_view::npos; });
}

Action tune(const std::string& name, double value) {
    Action result = action(Verb::Tune, "e1");
    result.property = name;
    result.value = value;
    return result;
}

}  // namespace

TEST_CASE("a parameter that is tuned gives the readings of one that was so from the start") {
    int compared = 0, differ = 0;
    World plain_room = tuned_room();
    WorldModel plain(plain_room);
    wait(plain, 2000);
    for (const ParameterInfo& info : parameter_table()) {
        const std::string name = info.name;
        const double value =
            info.min +
            0.6 * (std::min(info.max, info.min + 10 * std::abs(info.defaults.front()) + 1e-3) - info.min);
        if (!problem_of_tuning(name, value).empty() || goes_by_chance(name) || name.starts_with("battery."))
            continue;
        INFO(name << " = " << value);
        World from_start = tuned_room();
        from_start.robots[0].parameters[name] = value;
        WorldModel expected(from_start);
        wait(expected, 2000);
        WorldModel model(tuned_room());
        Scene scene(model);
        wait(model, 1000);
        REQUIRE(scene.apply(tune(name, value)).empty());
        wait(model, 1000);
        const Channels& now = model.robot(0).channels();
        for (std::size_t i = 0; i < now.size(); ++i) {
            INFO("channel " << i);
            CHECK(now[i] == Approx(expected.robot(0).channels()[i]).margin(0.05));
        }
        ++compared;
        differ += now == plain.robot(0).channels() ? 0 : 1;
    }
    CHECK(compared >= 50);
    CHECK(differ >= 30);  // the others need a robot that drives, a second motor, a dead zone
}

TEST_CASE("drift of the floor and a lower battery begin when they are tuned") {
    WorldModel model(tuned_room());
    Scene scene(model);
    wait(model, 100);
    const double charged = model.robot(0).channels()[kBatteryVoltageChannel];
    REQUIRE(scene.apply(tune("battery.idle_power", 2.0)).empty());
    wait(model, 10);
    CHECK(model.robot(0).channels()[kBatteryVoltageChannel] < charged);
    CHECK(model.robot(0).floor_is_still());
    REQUIRE(scene.apply(tune("robot.drift_x", 0.01)).empty());
    CHECK_FALSE(model.robot(0).floor_is_still());
}

TEST_CASE("what is built once, or is another medium's, is not tuned") {
    WorldModel model(tuned_room());
    Scene scene(model);
    const auto refused = [&](const char* name, double value, const char* part) {
        INFO(name);
        const std::string problem = scene.apply(tune(name, value));
        CHECK(problem.find(part) != std::string::npos);
        CHECK(problem.find('\n') == std::string::npos);
    };
    for (const char* name :
         {"robot.radius", "robot.mass", "robot.wheel_radius_left", "robot.load", "contact.mu", "camera.noise",
          "ir.loss", "microphone.gain", "world.slope_x", "push.rate"})
        refused(name, Parameters().get(name), "does not change while the run is on");
    refused("proximity.age", 0.1, "does not change while the run is on");
    refused("battery.charge", 0.5, "set ROBOT charge");
    refused("proximity.gian", 1.0, "proximity.gain");
    refused("proximity.gain", 100.0, "range");
    refused("proximity.gain", NAN, "range");
    Action other = tune("proximity.gain", 0.5);
    other.object = "crate";
    CHECK(scene.apply(other).find("is no robot") != std::string::npos);
}
