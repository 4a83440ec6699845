// The plain models at rest are what the simulator assumes; figures worked out by hand.

#include "selftest/benches/design_motion.h"
#include "selftest/plain/plain_accelerometer.h"
#include "selftest/plain/plain_motion.h"
#include "selftest/plain/plain_proximity.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace puckloop::gap::selftest;

namespace {

MotionRow end_of(const MotionKnobs& knobs, double left, double right, double seconds) {
    MotionScript script;
    script.seconds = seconds + 1;
    script.commands = {{0, left, right}, {seconds, 0, 0}};
    return drive(knobs, script, 0.1, puckloop::RandomStream(1, "x")).back();
}

}  // namespace

TEST_CASE("a thousand steps are one turn of a 41 mm wheel") {
    const MotionRow row = end_of({}, 500, 500, 2);
    CHECK(row.steps_left == Approx(1000).margin(1));
    CHECK(row.x == Approx(std::numbers::pi * 0.041).margin(2e-4));
    CHECK(row.y == Approx(0).margin(1e-9));
}

TEST_CASE("the agenda's staircase") {
    CHECK(agenda_speed(800) == Approx(10000.0 / 12));
    CHECK(agenda_speed(-300) == Approx(-10000.0 / 33));
    CHECK(agenda_speed(0) == 0.0);
}

TEST_CASE("a spin turns by the difference of the wheels over the axle") {
    const MotionRow row = end_of({}, -250, 250, 2);
    CHECK(row.theta == Approx(2 * 500 * 2 * std::numbers::pi * 0.0205 / 1000 / 0.053).epsilon(0.005));
    MotionKnobs longer;
    longer.axle_scale = 1.02;
    CHECK(end_of(longer, -250, 250, 2).theta == Approx(row.theta / 1.02));
}

TEST_CASE("a start on a slippery floor loses v^2 / 2 mu g") {
    MotionKnobs slippery;
    slippery.friction = 0.05;
    MotionScript script;
    script.seconds = 2;
    script.commands = {{0, 500, 500}};
    const auto with = drive(slippery, script, 0.1, puckloop::RandomStream(1, "x")).back();
    const auto without = drive({}, script, 0.1, puckloop::RandomStream(1, "x")).back();
    const double v = 500 * 2 * std::numbers::pi * 0.0205 / 1000;
    const double loss = v * v / (2 * 9.81) * (1 / 0.05 - 1 / 0.7);
    CHECK(without.x - with.x == Approx(loss).margin(1e-4));
}

TEST_CASE("a command takes effect at its own moment, not at the next millisecond") {
    MotionScript script;
    script.seconds = 1;
    script.commands = {{0, 500, 500}};
    const auto way = [&](double latency) {
        MotionKnobs late;
        late.latency = latency;
        return drive(late, script, 0.1, puckloop::RandomStream(1, "x")).back().x;
    };
    const double v = 500 * 2 * std::numbers::pi * 0.0205 / 1000;
    // The slide at the start ends within a tick.
    CHECK(way(0.0060) - way(0.0064) == Approx(0.0004 * v).epsilon(0.05));
    CHECK(way(0.0064) - way(0.0070) == Approx(0.0006 * v).epsilon(0.05));
}

TEST_CASE("a sensor before a white wall reads the table and its offset") {
    puckloop::RandomStream chance(1, "x");
    Scene scene{};
    scene.sensor = 0;
    scene.gap = 0.020;
    scene.reflectivity = 1.0;
    CHECK(see({}, scene, false, chance).proximity[0] == Approx(52 + 383.84).margin(1.0));
    scene.gap = 0.5;
    CHECK(see({}, scene, false, chance).proximity[0] == Approx(52));
}

TEST_CASE("an accelerometer at rest reads one g upwards") {
    const auto level = feel({}, {});
    CHECK(level[0] == Approx(2048));
    CHECK(level[2] == Approx(2848));
    Attitude nose_up{};
    nose_up.pitch = 0.1;
    CHECK(feel({}, nose_up)[1] == Approx(2048 - 800 * std::sin(0.1)));
}
