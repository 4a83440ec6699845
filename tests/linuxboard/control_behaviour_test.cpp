// The example behaviours and the conversion between records and what behaviours see.

#include "linuxboard/control/control_loop.h"

#include <catch2/catch.hpp>

using namespace puckloop::control;

TEST_CASE("records and behaviour units convert both ways") {
    puckloop::protocols::EpuckSensors record;
    record.proximity = {-3, 100, 0, 0, 0, 0, 0, 4000};
    record.light.fill(4000);
    record.light[2] = 100;
    record.battery_ok = 1;
    const Sensors sensors = to_sensors(record);
    CHECK(sensors.proximity[0] == 0);
    CHECK(sensors.proximity[7] == 4000);
    CHECK(sensors.light[0] == 95);
    CHECK(sensors.light[2] == 3995);

    CHECK(to_record({.left_mm_s = 64.4026}).left == 500);
    CHECK(to_record({.right_mm_s = -1e9}).right == -1000);
    CHECK(to_record({.left_mm_s = std::numeric_limits<double>::quiet_NaN()}).left == 0);
    CHECK(to_record({.front_led = true, .body_led = true}).other_leds == 3);
}

TEST_CASE("wander drives on in the open and turns away from a wall on either side") {
    const auto wander = make_behaviour("wander");
    Sensors open;
    const Actuators on = wander->step(open, 0);
    CHECK(on.left_mm_s > 0);
    CHECK(on.left_mm_s == on.right_mm_s);

    Sensors wall = open;
    wall.proximity[0] = 800;  // front right
    const Actuators away = wander->step(wall, 0.1);
    CHECK(away.left_mm_s < 0);
    CHECK(away.right_mm_s > 0);
    for (double t = 0.2; t < 5; t += 0.1)
        wander->step(open, t);
    CHECK(wander->step(open, 5).left_mm_s > 0);

    wall = open;
    wall.proximity[6] = 800;  // left
    CHECK(wander->step(wall, 5.1).left_mm_s > 0);
    CHECK(wander->step(wall, 5.2).right_mm_s < 0);
}

TEST_CASE("wander learns each sensor's own offset") {
    const auto wander = make_behaviour("wander");
    Sensors offset;
    offset.proximity.fill(110);
    CHECK(wander->step(offset, 0).left_mm_s > 0);
    offset.proximity[7] = 180;
    CHECK(wander->step(offset, 0.1).left_mm_s > 0);
    offset.proximity[7] = 300;
    CHECK(wander->step(offset, 0.2).left_mm_s > 0);
    CHECK(wander->step(offset, 0.3).right_mm_s < 0);
}

TEST_CASE("drive to light turns towards the lamp, goes on when it is ahead, stops at it") {
    const auto behaviour = make_behaviour("light");
    Sensors s;
    s.light.fill(300);
    s.light[5] = 900;  // left
    Actuators a = behaviour->step(s, 0);
    CHECK(a.right_mm_s > a.left_mm_s);
    s.light[5] = 300;
    s.light[2] = 900;  // right
    a = behaviour->step(s, 0.1);
    CHECK(a.left_mm_s > a.right_mm_s);
    s.light[2] = 300;
    s.light[0] = s.light[7] = 900;  // ahead
    a = behaviour->step(s, 0.2);
    CHECK(a.left_mm_s == Approx(a.right_mm_s).margin(0.01));
    CHECK(a.left_mm_s > 50);
    s.light[0] = s.light[7] = 3900;
    a = behaviour->step(s, 0.3);
    CHECK(a.left_mm_s == 0);
    CHECK(a.right_mm_s == 0);
    CHECK(a.body_led);
}

TEST_CASE("drive to light stops where the light begins to weaken, and goes on when the lamp moves away") {
    const auto behaviour = make_behaviour("light");
    Sensors s;
    s.light.fill(300);
    for (const double brightness : {1000.0, 2000.0, 2500.0, 2450.0}) {
        s.light[0] = s.light[7] = brightness;
        CHECK(behaviour->step(s, 0).left_mm_s > 0);
    }
    s.light[0] = s.light[7] = 2200;  // below the lamp
    CHECK(behaviour->step(s, 0.1).left_mm_s == 0);
    s.light[0] = s.light[7] = 2500;
    CHECK(behaviour->step(s, 0.2).left_mm_s == 0);
    s.light[0] = s.light[7] = 900;
    CHECK(behaviour->step(s, 0.3).left_mm_s > 0);
}

TEST_CASE("an unknown behaviour is refused") {
    CHECK(make_behaviour("dance") == nullptr);
}
