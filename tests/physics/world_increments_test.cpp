// A world's step computes only what something can have changed. Here it is held to the plain way, bit for
// bit: everything against everything at every step, on random worlds with things that move and hands.

#include "tests/physics/plain_world.h"
#include "tests/physics/random_world.h"

#include <catch2/catch.hpp>

#include <bit>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

template <std::size_t N>
bool same_bits(const std::array<double, N>& a, const std::array<double, N>& b) {
    for (std::size_t i = 0; i < N; ++i)
        if (std::bit_cast<std::uint64_t>(a[i]) != std::bit_cast<std::uint64_t>(b[i])) return false;
    return true;
}

/// Some of the parameters that change what a sensor looks at or how.
void vary_optics(World& world, RandomStream& chance) {
    auto& p = world.parameters;
    p["proximity.rays"] = static_cast<double>(1 + chance.below(6));
    p["proximity.aperture"] = between(chance, 0, 0.6);
    p["proximity.reach"] = between(chance, 0.05, 0.3);
    p["proximity.height"] = between(chance, 0.02, 0.08);
    if (chance.below(2) == 0) p["proximity.incidence_exponent"] = between(chance, 0.5, 3);
    p["proximity.ambient_offset"] = between(chance, -100, 100);
    p["proximity.ambient_gain"] = between(chance, -0.3, 0.5);
    p["light.range"] = between(chance, 0.3, 3);
    if (chance.below(3) == 0) p["light.flicker"] = 0.2;
    p["ground.footprint"] = between(chance, 0, 0.02);
}

/// Overlays with noise, delays and drifts.
void vary_effects(World& world, RandomStream& chance) {
    auto& p = world.parameters;
    const auto maybe = [&](const char* name, double low, double high) {
        if (chance.below(2) == 0) p[name] = between(chance, low, high);
    };
    maybe("proximity.warmup_gain", -0.2, 0.2);
    maybe("proximity.battery_gain", -0.5, 0.5);
    maybe("proximity.motor_sag", 0, 0.1);
    maybe("proximity.age", 0, 0.05);
    maybe("proximity.motor_noise", 0, 1);
    maybe("proximity.proportional_noise", 0, 0.1);
    maybe("proximity.interference_rate", 0, 0.3);
    maybe("proximity.flicker", 0, 30);
    maybe("ground.lag", 0, 0.05);
    maybe("ground.acceleration_tilt", -0.1, 0.1);
    maybe("accelerometer.vibration", 0, 100);
    maybe("robot.turn_scrub", 0, 1);
    maybe("push.rate", 0.5, 1);
}

}  // namespace

TEST_CASE("sensors and contacts are those of a plain look at everything", "[increments]") {
    for (std::uint64_t round = 0; round < 25; ++round) {
        RandomStream chance(round, "increments");
        World world = random_world(chance, 8);
        vary_optics(world, chance);
        WorldModel model(world);
        Scene scene(model);
        Herd herd(model, round);
        PlainWorld plain(model);
        const bool hands = round % 3 != 0;
        for (int step = 0; step < 600; ++step) {
            herd.feed();
            const auto touching = plain.contacts();
            model.move_bodies();
            CAPTURE(round, step);
            const auto found = model.dynamics().robot_contacts();
            REQUIRE(std::vector<RobotContact>(found.begin(), found.end()) == touching);
            scene.glide();
            const bool acts = hands && chance.below(20) == 0;
            if (acts) static_cast<void>(scene.apply(random_action(chance, world)));
            model.sense();
            plain.look(hands);
            for (std::size_t i = 0; i < model.robot_count(); ++i) {
                const Parameters& p = model.parameters();
                CAPTURE(i);
                const auto reflected = plain.reflected(i, p.proximity);
                REQUIRE(same_bits(model.robot(i).reflected(), reflected));
                std::array<double, kProximitySensors> ambient{}, proximity{};
                const auto& channels = model.robot(i).channels();
                std::copy_n(channels.begin() + kAmbientChannel, ambient.size(), ambient.begin());
                std::copy_n(channels.begin() + kProximityChannel, proximity.size(), proximity.begin());
                REQUIRE(same_bits(ambient, plain.ambient(i, p.light, p.proximity)));
                const auto& ring = model.robot(i).proximity();
                REQUIRE(same_bits(
                    proximity,
                    ring.readable(ring.answer(reflected, {.ambient = model.description().ambient_light}))));
                if (!hands) REQUIRE(same_bits(model.robot(i).greys(), plain.greys(i, p.ground)));
            }
        }
    }
}

TEST_CASE("nothing is another if everything is computed anew at every step", "[increments]") {
    for (std::uint64_t round = 0; round < 16; ++round) {
        RandomStream chance(round, "anew");
        World world = random_world(chance, 8);
        vary_optics(world, chance);
        vary_effects(world, chance);
        WorldModel model(world), anew(world);
        Scene scene(model), scene_anew(anew);
        Herd herd(model, round), herd_anew(anew, round);
        Action nothing;  // the floor is as it was: yet the scene counts as changed
        nothing.verb = Verb::Set;
        nothing.object = "floor";
        nothing.property = "grey";
        for (int step = 0; step < 600; ++step) {
            herd.feed();
            herd_anew.feed();
            for (auto* one : {&model, &anew})
                one->move_bodies();
            scene.glide();
            scene_anew.glide();
            if (chance.below(25) == 0) {
                const Action action = random_action(chance, world);
                REQUIRE(scene.apply(action) == scene_anew.apply(action));
            }
            nothing.value = anew.description().arena.floor_grey;
            REQUIRE(scene_anew.apply(nothing).empty());
            model.sense();
            anew.sense();
            CAPTURE(round, step);
            for (std::size_t i = 0; i < model.robot_count(); ++i) {
                CAPTURE(i);
                const RobotState &a = model.state(i), &b = anew.state(i);
                REQUIRE(same_bits(std::array{a.x, a.y, a.heading, a.pitch, a.roll, a.wheel[0], a.wheel[1]},
                                  std::array{b.x, b.y, b.heading, b.pitch, b.roll, b.wheel[0], b.wheel[1]}));
                // Ground sensors look again after 2 um or 50 urad only: what a robot has crept meanwhile
                // shows where it is looked at anew. The plain look above holds them.
                Channels mine = model.robot(i).channels(), theirs = anew.robot(i).channels();
                std::fill_n(mine.begin() + kGroundChannel, kGroundSensors, 0.0);
                std::fill_n(theirs.begin() + kGroundChannel, kGroundSensors, 0.0);
                REQUIRE(same_bits(mine, theirs));
            }
        }
    }
}

TEST_CASE("the floor under a robot is that of a plain look at all patches", "[increments]") {
    RandomStream chance(3, "floor");
    int partly = 0;
    for (int round = 0; round < 300; ++round) {
        Parameters parameters;
        parameters.ground.footprint = between(chance, 0, 0.02);
        parameters.ground.x = between(chance, -0.05, 0.05);
        std::vector<Patch> patches;
        for (std::uint64_t i = chance.below(5); i > 0; --i)
            patches.push_back({.name = "patch",
                               .shape = chance.below(2) == 0 ? Patch::Shape::Disc : Patch::Shape::Rectangle,
                               .x = between(chance, -.3, .3),
                               .y = between(chance, -.3, .3),
                               .heading = between(chance, -4, 4),
                               .length = between(chance, .01, .3),
                               .width = between(chance, .01, .3),
                               .radius = between(chance, .005, .1),
                               .grey = chance.uniform()});
        const double base = chance.uniform();
        const GroundRow row(parameters.ground, base, patches);
        for (int i = 0; i < 200; ++i) {
            RobotState robot;
            robot.x = between(chance, -.4, .4);
            robot.y = between(chance, -.4, .4);
            robot.heading = between(chance, -4, 4);
            const auto greys = PlainWorld::greys(parameters.ground, base, patches, robot);
            REQUIRE(same_bits(row.greys(robot), greys));
            if (greys[0] != greys[2]) ++partly;
        }
    }
    CHECK(partly > 1000);
}

TEST_CASE("a power of one is the number itself") {  // ProximityRing leaves the work out
    RandomStream chance(1, "powers");
    for (int i = 0; i < 1'000'000; ++i) {
        const double x = chance.uniform();
        REQUIRE(std::pow(x, 1.0) == x);
    }
}
