// Light between boards: where it falls, what shades it, how it adds up and fades.

#include "base/error.h"
#include "tests/physics/ir_worlds.h"

#include <catch2/catch.hpp>

#include <numbers>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;

TEST_CASE("light falls on the receivers that look at the sender, and only there") {
    // b sees a at 180 deg: receivers 5 (159) and 6 (-165) face it, 0 and 11 look away.
    IrMedium medium(ideal_pair(0.3));
    const IrLight& light = shine(medium);
    CHECK(strongest(light.level) == 6);
    CHECK(strongest(light.carrier) == 6);
    for (const std::size_t away : {0U, 1U, 2U, 9U, 10U, 11U}) {
        CHECK(light.level[away] == 0.0F);
        CHECK(light.carrier[away] == 0.0F);
    }
    for (const std::size_t facing : {4U, 5U, 6U, 7U})
        CHECK(light.level[facing] > 0.0F);
    // Strength goes with sqrt(cos): 159 against -165 deg, emitters far away.
    const double turn = std::numbers::pi / 180;
    CHECK(light.level[5] / light.level[6] ==
          Approx(std::sqrt(std::cos(21 * turn) / std::cos(15 * turn))).epsilon(0.02));
}

TEST_CASE("turning the receiving robot turns the picture") {
    const double turn = std::numbers::pi / 180;
    const double angles[] = {15, 50, 75, 105, 133, 159, -165, -135, -105, -77, -50, -15};
    for (std::size_t k = 0; k < kIrSensors; ++k) {
        IrMedium medium(ideal_pair(0.5, std::numbers::pi - angles[k] * turn));
        CHECK(strongest(shine(medium).level) == k);
    }
}

TEST_CASE("one emitter reaches where it points") {
    IrMedium medium(ideal_pair(1.0));                      // far, so that its place on the rim hardly matters
    const double ahead = shine(medium, 1U << 0).level[6];  // 15 deg off the line
    const double aside = shine(medium, 1U << 1).level[6];  // 50 deg
    CHECK(aside / ahead == Approx(std::cos(0.8727) / std::cos(0.2618)).epsilon(0.06));
    CHECK(shine(medium, 1U << 5).level[6] == 0.0F);  // points away
    const double both = shine(medium, 0b11).level[6];
    CHECK(both == Approx(ahead + aside));
}

TEST_CASE("carrier fades with the inverse square, level follows the measured curve") {
    const auto at = [](double surface) {
        IrMedium medium(ideal_pair(surface));
        const IrLight light = shine(medium);
        return std::pair<double, double>(light.carrier[6], light.level[6]);
    };
    const double offset = 0.006 + 0.01;  // parts inside the rim, d0; the emitters aside are a little further
    CHECK(at(0.4).first / at(0.8).first ==
          Approx(std::pow((0.8 + offset) / (0.4 + offset), 2)).epsilon(0.07));
    CHECK(at(0.45).second / at(0.8).second == Approx(1.0).epsilon(0.03));
    CHECK(at(0.05).second > 1.2 * at(0.15).second);
    CHECK(at(0.02).second > 1.2 * at(0.05).second);
    CHECK(at(1.6).second < at(0.8).second / 3);
}

TEST_CASE("the potentiometer sets how far the board is heard: 0 farthest, 255 next to nothing") {
    IrMedium medium(ideal_pair(0.3));
    const double reference = shine(medium, kAllEmitters, 115).carrier[6];
    CHECK(shine(medium, kAllEmitters, 0).carrier[6] / reference == Approx(255.0 / 140.0).epsilon(0.01));
    CHECK(shine(medium, kAllEmitters, 170).carrier[6] < reference);
    CHECK(shine(medium, kAllEmitters, 255).carrier[6] < 0.01);
    // Strength is compressed: more power is a shorter way on a flat curve.
    const double level = shine(medium, kAllEmitters, 115).level[6];
    const double full = shine(medium, kAllEmitters, 0).level[6];
    CHECK(full > level);
    CHECK(full < 1.2 * level);
}

TEST_CASE("a demodulator answers to its own frequency") {
    IrMedium medium(ideal_pair(0.3));
    const double centre = shine(medium, kAllEmitters, 115, 455e3).carrier[6];
    CHECK(shine(medium, kAllEmitters, 115, kFirmwareCarrier).carrier[6] / centre ==
          Approx(0.774).epsilon(0.01));
    CHECK(shine(medium, kAllEmitters, 115, 57.6e3).carrier[6] / centre < 0.03);
    CHECK(shine(medium, kAllEmitters, 115, 0).carrier[6] == 0.0F);
}

TEST_CASE("bodies, walls, boxes and cylinders shade, what is low or aside does not") {
    const auto carrier = [](auto change) {
        World world = ideal_pair(0.4);
        change(world);
        IrMedium medium(world);
        return total(shine(medium).carrier);
    };
    const double free = carrier([](World&) {});
    CHECK(free > 0.0);
    CHECK(carrier([](World& w) { w.robots.push_back(robot_at("c", 0.235, 0)); }) < 0.25 * free);
    CHECK(carrier([](World& w) { w.robots.push_back(robot_at("c", 0.235, 0.2)); }) == Approx(free));
    CHECK(carrier([](World& w) { w.walls.push_back({"w", {0.2, -1}, {0.2, 1}}); }) == 0.0);
    CHECK(carrier([](World& w) {
              w.walls.push_back({"w", {0.2, -1}, {0.2, 1}, 0.01, 0.04});
          }) == Approx(free));
    CHECK(carrier([](World& w) { w.boxes.push_back({.name = "x", .x = 0.2, .width = 0.3}); }) == 0.0);
    CHECK(carrier([](World& w) {
              w.cylinders.push_back({.name = "p", .x = 0.235, .radius = 0.1, .movable = true});
          }) == 0.0);
    // Half of the way shaded: some pairs of parts see each other, others do not.
    const double half = carrier([](World& w) { w.walls.push_back({"w", {0.235, 0}, {0.235, 1}}); });
    CHECK(half > 0.2 * free);
    CHECK(half < 0.8 * free);
}

TEST_CASE("a moving thing opens and closes the way at the next burst") {
    World world = ideal_pair(0.4);
    world.cylinders.push_back({.name = "p", .x = 0.235, .radius = 0.1, .movable = true});
    IrMedium medium(world);
    CHECK(total(shine(medium).carrier) == 0.0);
    medium.move(2, 0.235, 0.8, 0);
    CHECK(total(shine(medium).carrier) > 1.0);
    medium.move(1, 0.25, 0, 0);  // b comes nearer
    const double near = total(shine(medium).carrier);
    medium.move(1, 0.47, 0, 0);
    CHECK(total(shine(medium).carrier) < near / 2);
}

TEST_CASE("two senders add up at a third, the dark reads baseline and room light") {
    World world = ideal_pair(0.3);
    world.robots.push_back(rab_robot("c", 0.37 / 2, 0.4));
    world.ambient_light = 2.0;
    world.parameters["ir.baseline"] = 100;
    world.parameters["ir.ambient"] = 25;
    IrMedium medium(world);
    CHECK(medium.at(2).level[3] == 150.0F);
    CHECK(medium.at(2).carrier[3] == 0.0F);
    for (const std::size_t sender : {0U, 1U}) {
        medium.set_power(sender, 115);
        medium.set_carrier(sender, kFirmwareCarrier);
        medium.set_emitters(sender, kAllEmitters);
        medium.begin_burst(sender, 0);
    }
    for (std::size_t k = 0; k < kIrSensors; ++k) {
        const float a = medium.from(0, 2).level[k];
        const float b = medium.from(1, 2).level[k];
        CHECK(medium.at(2).level[k] == Approx(150 + a + b));
        CHECK(medium.at(2).carrier[k] == Approx(medium.from(0, 2).carrier[k] + medium.from(1, 2).carrier[k]));
    }
    medium.set_emitters(0, 0);
    CHECK(medium.at(2).level[8] == Approx(150 + medium.from(1, 2).level[8]));
}

TEST_CASE("a board hears itself only by a parameter, or by a wall that reflects") {
    World world;
    world.arena = rectangular_arena(4, 4);
    world.robots = {rab_robot("a", 0, 0)};
    make_ideal(world);
    CHECK_FALSE(IrMedium(world).can_hear(0));
    const auto heard = [&world] {
        IrMedium medium(world);
        medium.set_power(0, 115);
        medium.set_carrier(0, kFirmwareCarrier);
        medium.set_emitters(0, kAllEmitters);
        medium.begin_burst(0, 0);
        return medium.at(0);
    };
    world.parameters["ir.self_coupling"] = 0.2;
    CHECK(heard().carrier[4] == Approx(0.2 * 12 * 0.774).epsilon(0.01));
    world.parameters["ir.self_coupling"] = 0.0;
    world.parameters["ir.reflection"] = 0.1;
    CHECK(total(heard().carrier) < 0.15);  // the arena's own walls, 2 m away
    world.walls.push_back({"w", {0.15, -1}, {0.15, 1}});
    const auto light = heard();
    CHECK(std::max(light.carrier[0], light.carrier[11]) > 1.0F);
    CHECK(light.carrier[5] < 0.02F);
}

TEST_CASE("a wall beside two boards mirrors their light, one between them does not") {
    World world = ideal_pair(0.3);
    world.parameters["ir.reflection"] = 0.5;
    world.walls.push_back({"side", {-1, 0.2}, {1, 0.2}});
    IrMedium with(world);
    const IrLight mirrored = shine(with);
    world.parameters["ir.reflection"] = 0.0;
    IrMedium without(world);
    const IrLight direct = shine(without);
    CHECK(mirrored.carrier[3] > direct.carrier[3] + 0.5F);                 // looks at the wall
    CHECK(mirrored.carrier[8] == Approx(direct.carrier[8]).margin(0.05));  // looks away from it
    world.walls[0] = {"between", {0.185, -1}, {0.185, 1}};
    world.parameters["ir.reflection"] = 0.5;
    IrMedium split(world);
    CHECK(total(shine(split).carrier) < 0.4);  // round by the arena's walls, 4 m
}

TEST_CASE("parts and bursts differ by their spreads, the same for the same seed") {
    World world = rab_pair(0.3);
    const auto levels = [](const World& w, int bursts) {
        IrMedium medium(w);
        std::vector<float> all;
        for (int i = 0; i < bursts; ++i)
            all.push_back(shine(medium).level[6]);
        return all;
    };
    const auto first = levels(world, 400);
    CHECK(levels(world, 400) == first);
    double mean = 0.0;
    double square = 0.0;
    for (const float level : first) {
        mean += std::log(level) / 400;
        square += std::log(level) * std::log(level) / 400;
    }
    CHECK(std::sqrt(square - mean * mean) == Approx(std::hypot(0.1, 0.05)).epsilon(0.15));
    world.seed = 2;
    CHECK(levels(world, 1) != std::vector<float>{first[0]});
}

TEST_CASE("parameters of the medium are set by name and number") {
    World world = ideal_pair(0.3);
    const auto level = [&world] {
        IrMedium medium(world);
        return shine(medium).level[6];
    };
    const float before = level();
    world.robots[1].parameters["ir.receiver_gain6"] = 0.5;
    CHECK(level() == Approx(before / 2));
    world.robots[1].parameters = {{"ir.receiver_gain11", 0.5}};
    CHECK(level() == Approx(before));
    world.robots[1].parameters = {{"ir.receiver_gain12", 0.5}};
    CHECK_THROWS_AS(check(world), InputError);
    world.robots[1].parameters = {{"ir.receiver_gain01", 0.5}};
    CHECK_THROWS_AS(check(world), InputError);
    world.robots[1].parameters = {{"ir.distance3", 0.2}};  // beyond the next point
    CHECK_THROWS_AS(check(world), InputError);
}
