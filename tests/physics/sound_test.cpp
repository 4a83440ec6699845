// Loudspeakers at a robot's microphones: the law, powers, the robot's own noise, and silence.

#include "base/error.h"
#include "physics/node/world_node.h"
#include "physics/sensors/sound.h"
#include "tests/physics/worlds.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

Speaker speaker(const std::string& name, double x, double y, double level) {
    return {.name = name, .x = x, .y = y, .level = level};
}

/// Of microphone 1, which stands at (15, 26) mm and looks 60 degrees to the left, after `seconds`.
double left_level(const World& world, double seconds = 0.0) {
    WorldModel model(world);
    while (model.seconds() < seconds - 1e-9)
        model.step();
    return model.robot(0).channels()[kMicrophoneChannel + 1];
}

/// `distance` before microphone 1, `off` its axis.
Speaker before_left(double distance, double off, double level) {
    const double way = 1.0472 + off;
    return speaker("horn", 0.015 + distance * std::cos(way), 0.026 + distance * std::sin(way), level);
}

}  // namespace

TEST_CASE("a level falls from 0.1 m on with the distance, and turns with the robot") {
    World world = world_with_robot();
    world.speakers = {before_left(0.1, 0.0, 500)};
    CHECK(left_level(world) == Approx(500).epsilon(1e-4));
    world.speakers = {before_left(0.4, 1.2, 500)};
    CHECK(left_level(world) == Approx(125).epsilon(1e-4));
    world.parameters = {{"microphone.exponent", 1.16}, {"microphone.gain1", 0.9}};
    CHECK(left_level(world) == Approx(0.9 * 500 * std::pow(0.25, 1.16)).epsilon(1e-4));
    world.speakers = {speaker("horn", 1, 0, 500)};
    const double plain = left_level(world);
    world.robots[0].heading = 2.0;
    world.speakers = {speaker("horn", std::cos(2.0), std::sin(2.0), 500)};
    world.arena = rectangular_arena(4, 4);
    CHECK(left_level(world) == Approx(plain));
}

TEST_CASE("directed microphones hear more from before them") {
    World world = world_with_robot();
    world.parameters = {{"microphone.directivity", 0.3}};
    for (const double off : {0.0, 1.0, 3.1}) {
        world.speakers = {before_left(0.2, off, 400)};
        CHECK(left_level(world) == Approx(200 * (1 + 0.3 * std::cos(off))).epsilon(1e-4));
    }
}

TEST_CASE("several loudspeakers add as powers, each between its times") {
    World world = world_with_robot();
    world.speakers = {before_left(0.1, 0.0, 300), before_left(0.1, 0.5, 400)};
    world.speakers[1].name = "other";
    CHECK(left_level(world) == Approx(500).epsilon(1e-4));
    world.speakers[1].on = 0.01;
    world.speakers[1].off = 0.02;
    CHECK(left_level(world, 0.005) == Approx(300).epsilon(1e-4));
    CHECK(left_level(world, 0.015) == Approx(500).epsilon(1e-4));
    CHECK(left_level(world, 0.025) == Approx(300).epsilon(1e-4));
}

TEST_CASE("the robot's own noise adds: always, and with its motors") {
    World world = world_with_robot();
    world.parameters = {{"microphone.self_noise", 12}, {"microphone.motor_noise", 40}};
    CHECK(left_level(world) == 12);
    world.speakers = {before_left(0.2, 0.0, 400)};
    CHECK(left_level(world) == Approx(212).epsilon(1e-4));
    world.speakers.clear();
    WorldModel model(world);
    Driver(model).drive(-500, 500, 0.5);
    CHECK(model.robot(0).channels()[kMicrophoneChannel] == Approx(12 + 20).margin(0.5));
}

TEST_CASE("microphones warm up, and a level ends at full scale") {
    World world = world_with_robot();
    world.parameters = {{"microphone.warmup_gain", 0.5}, {"microphone.warmup_time", 1}};
    world.speakers = {before_left(0.1, 0.0, 400)};
    CHECK(left_level(world, 0.7) == Approx(400 * (1 + 0.5 * (1 - std::exp(-0.7)))).epsilon(1e-3));
    world.speakers = {before_left(0.1, 0.0, 5000)};
    CHECK(left_level(world) == 4095);
}

TEST_CASE("a world without sound sends nothing of it on the links") {
    World world = world_with_robot();
    constexpr std::uint16_t kLevel = 60;
    for (std::uint16_t i = 0; i < 4; ++i)
        world.robots[0].board_signals[std::string(channel_name(kMicrophoneChannel + i))] =
            static_cast<std::uint16_t>(kLevel + i);
    const auto told = [](const World& described) {
        WorldNode node(described);
        std::vector<cosim::Message> out;
        node.advance(50 * cosim::kMillisecond, {}, out);
        return out.size();
    };
    CHECK(told(world) == 0);
    world.speakers = {speaker("horn", 0.5, 0, 400)};
    CHECK(told(world) == 3);
    world.parameters = {{"microphone.window_lost", 0.25}};
    CHECK(told(world) == 4);
}

TEST_CASE("a loudspeaker travels as JSON, a bad one is refused with its name") {
    World world = world_with_robot();
    world.speakers = {{.name = "horn",
                       .x = 0.1,
                       .y = -0.2,
                       .height = 0.4,
                       .level = 700,
                       .on = 1,
                       .off = 2,
                       .every = 3,
                       .times = 4,
                       .tone = 500,
                       .sweep_to = 600,
                       .place = "line 7"}};
    const Speaker back = from_json(to_json(world)).speakers.at(0);
    CHECK(back.y == -0.2);
    CHECK(back.height == 0.4);
    CHECK(back.every == 3);
    CHECK(back.times == 4);
    CHECK(back.tone == 500);
    CHECK(back.sweep_to == 600);
    CHECK(back.level == 700);
    CHECK(back.on == 1);
    CHECK(back.off == 2);
    world.speakers[0].off = 0.5;
    CHECK_THROWS_WITH(check(world), Catch::Contains("line 7") && Catch::Contains("speaker 'horn'"));
    world.speakers[0].off = 2;
    world.speakers[0].level = -1;
    CHECK_THROWS_AS(check(world), InputError);
}
