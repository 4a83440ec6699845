// Sensors: response curves, directions, materials, light, ground, acceleration, battery.

#include "tests/physics/worlds.h"

#include <catch2/catch.hpp>

#include <numbers>

using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

constexpr double kPi = std::numbers::pi;

/// The robot, heading so that sensor 2 (right side, -90 deg, at radius 31 mm) looks at a wall `gap` away.
double sensor2_at(double gap, std::map<std::string, double> parameters = {}, double reflectivity = 1.0) {
    World world = world_with_robot(1, 1);
    world.arena.reflectivity = reflectivity;
    world.robots[0].y = -0.5 + 0.031 + gap;
    parameters["proximity.offset"] = 0;
    world.parameters = parameters;
    return WorldModel(world).robot(0).channels()[kProximityChannel + 2];
}

double channel(const World& world, std::size_t index) {
    return WorldModel(world).robot(0).channels()[index];
}

}  // namespace

TEST_CASE("a white wall straight ahead gives the measured counts") {
    // 0.5 %: the outer rays of the 0.1 rad aperture are 0.125 % longer and slanted.
    for (const auto& [millimetres, counts] :
         {std::pair{5.0, 2133.33}, {10.0, 1465.73}, {20.0, 383.84}, {40.0, 158.03}, {70.0, 67.19}})
        CHECK(sensor2_at(millimetres * 1e-3) == Approx(counts).epsilon(0.005));
    CHECK(sensor2_at(0.1) == Approx(20).epsilon(0.02));
    CHECK(sensor2_at(0.2) == 0);
}

TEST_CASE("other curves, gain, offset and reflectivity") {
    CHECK(sensor2_at(0.02, {{"proximity.curve", 1}, {"proximity.rays", 1}}) ==
          Approx(1 / (1 / 4095.0 + std::pow(29.9, 2) / 4.17e5)));
    CHECK(sensor2_at(0.02, {{"proximity.curve", 2},
                            {"proximity.rays", 1},
                            {"proximity.amplitude", 4000},
                            {"proximity.origin", 0.01}}) ==
          Approx(1 / (1 / 4095.0 + 1 / (4000 * std::exp(-2.0)))));
    const double plain = sensor2_at(0.02);
    CHECK(sensor2_at(0.02, {{"proximity.gain2", 1.5}}) == Approx(1.5 * plain));
    CHECK(sensor2_at(0.02, {{"proximity.gain3", 1.5}}) == Approx(plain));
    CHECK(sensor2_at(0.02, {}, 0.05) == Approx(0.05 * plain));
    CHECK(sensor2_at(0.0045, {{"proximity.gain", 5}}) == 4095);
    World free = world_with_robot();
    free.parameters["proximity.offset2"] = 77;
    CHECK(channel(free, kProximityChannel + 2) == 77);
    CHECK(channel(free, kProximityChannel + 7) == 45);  // its default
}

TEST_CASE("sensors are numbered clockwise from the front right") {
    const double bearings[] = {-17.2, -45.9, -90, -151.5, 151.2, 90, 45.8, 17.1};  // deg
    for (std::size_t i = 0; i < 8; ++i) {
        World world = world_with_robot();
        world.parameters["proximity.offset"] = 0;
        Cylinder post{.name = "post"};
        post.radius = 0.006;
        post.x = 0.075 * std::cos(bearings[i] * kPi / 180);
        post.y = 0.075 * std::sin(bearings[i] * kPi / 180);
        world.cylinders.push_back(post);
        const WorldModel model(world);
        for (std::size_t k = 0; k < 8; ++k) {
            INFO("post before sensor " << i << ", reading of " << k);
            if (k == i)
                CHECK(model.robot(0).channels()[k] > 20);
            else
                CHECK(model.robot(0).channels()[k] < 20);
        }
    }
}

TEST_CASE("a robot sees another robot and not itself, low things pass under the rays") {
    World world = world_with_robot();
    world.parameters["proximity.offset"] = 0;
    for (std::size_t i = 0; i < 8; ++i)
        CHECK(channel(world, i) == 0);
    world.robots.push_back(robot_at("e2", 0.031 + 0.02 + 0.035, -0.026));
    CHECK(channel(world, kProximityChannel + 0) > 50);
    CHECK(channel(world, kProximityChannel + 3) == 0);
    World low = world_with_robot();
    low.parameters["proximity.offset"] = 0;
    Box step{.name = "step"};
    step.x = 0.1;
    step.height = 0.03;
    low.boxes.push_back(step);
    CHECK(channel(low, kProximityChannel + 0) == 0);
    low.boxes[0].height = 0.04;
    CHECK(channel(low, kProximityChannel + 0) > 100);
}

TEST_CASE("ambient light: dark, room, and a lamp that falls with distance and angle") {
    World world = world_with_robot(8, 8);
    CHECK(channel(world, kAmbientChannel) == Approx(3700).margin(1));
    world.ambient_light = 0;
    CHECK(channel(world, kAmbientChannel) == 4000);
    Lamp lamp{.name = "lamp"};
    lamp.x = 0.03 + 0.5;
    lamp.y = 0.01;
    lamp.height = 0.0335;
    world.lamps.push_back(lamp);
    const double angle = 0.29845;  // of sensor 7 off the lamp
    CHECK(channel(world, kAmbientChannel + 7) ==
          Approx(4000 - 3600 * std::exp(-1.0) * (1 - 2 * angle / kPi)).margin(0.1));
    CHECK(channel(world, kAmbientChannel + 3) == 4000);  // looks away
    CHECK(channel(world, kAmbientChannel + 4) == 4000);
    CHECK(channel(world, kAmbientChannel + 7) < channel(world, kAmbientChannel + 6));
    CHECK(channel(world, kAmbientChannel + 6) < channel(world, kAmbientChannel + 5));
    world.lamps[0].x = 3;
    CHECK(channel(world, kAmbientChannel + 7) == 4000);  // beyond its range
}

TEST_CASE("bodies throw shadows unless the lamp is high enough") {
    World world = world_with_robot();
    world.ambient_light = 0;
    Lamp lamp{.name = "lamp"};
    lamp.x = 0.6;
    lamp.height = 0.05;
    world.lamps.push_back(lamp);
    const double lit = channel(world, kAmbientChannel + 7);
    CHECK(lit < 3900);
    Box screen{.name = "screen"};
    screen.x = 0.3;
    screen.length = 0.02;
    screen.width = 0.3;
    screen.height = 0.2;
    world.boxes.push_back(screen);
    CHECK(channel(world, kAmbientChannel + 7) == 4000);
    world.lamps[0].height = 0.5;
    CHECK(channel(world, kAmbientChannel + 7) < 4000);
    world.boxes.clear();
    world.lamps[0].height = 0.05;
    world.robots.push_back(robot_at("e2", 0.3, 0));
    CHECK(channel(world, kAmbientChannel + 7) == 4000);
}

TEST_CASE("a robot that turns towards a lamp brightens the sensor that comes to face it") {
    World world = world_with_robot();
    world.ambient_light = 0;
    Lamp lamp{.name = "lamp"};
    lamp.y = 0.7;
    world.lamps.push_back(lamp);
    WorldModel model(world);
    Driver driver(model);
    const auto brightest = [&] {
        const auto& c = model.robot(0).channels();
        return std::min_element(c.begin() + kAmbientChannel, c.begin() + kAmbientChannel + 8) - c.begin() -
               static_cast<std::ptrdiff_t>(kAmbientChannel);
    };
    CHECK(brightest() == 5);       // left
    driver.drive(-323, 323, 1.0);  // 90 degrees counter-clockwise and a little
    CHECK((brightest() == 0 || brightest() == 7));
}

TEST_CASE("ground sensors read the floor under them, left to right") {
    World world = world_with_robot();
    world.parameters["ground.footprint"] = 0;
    world.parameters["ground.noise"] = 0;
    CHECK(channel(world, kGroundChannel) == Approx(953).margin(0.01));
    Patch line{.name = "line"};
    line.x = 0.03;
    line.y = 0.0105;
    line.length = 0.1;
    line.width = 0.008;
    line.grey = 0;
    world.patches.push_back(line);
    Patch disc{.name = "spot"};
    disc.shape = Patch::Shape::Disc;
    disc.x = 0.03;
    disc.y = -0.0105;
    disc.radius = 0.004;
    disc.grey = 0.5;
    world.patches.push_back(disc);
    CHECK(channel(world, kGroundChannel + 0) == Approx(329).margin(0.01));
    CHECK(channel(world, kGroundChannel + 1) == Approx(953).margin(0.01));
    CHECK(channel(world, kGroundChannel + 2) == Approx(641).margin(0.01));
    world.parameters["ground.gain2"] = 0.5;
    world.parameters["ground.offset2"] = 10;
    CHECK(channel(world, kGroundChannel + 2) == Approx(330.5).margin(0.01));
    world.parameters["ground.gain1"] = 2;
    CHECK(channel(world, kGroundChannel + 1) == 967);  // saturated
    // A board 1 mm higher sees 4.4 % less.
    world.parameters["ground.height"] = 0.0025;
    CHECK(channel(world, kGroundChannel + 0) == Approx(329 * (1 - 0.04375)).margin(0.01));
}

TEST_CASE("a ground sensor crosses an edge where the edge is, softened by its footprint") {
    World world = world_with_robot();
    world.parameters["ground.noise"] = 0;
    world.parameters["ground.period"] = 0.001;
    Patch dark{.name = "dark"};
    dark.x = 0.5;
    dark.length = 0.8;  // from x = 0.1 on
    dark.width = 1.0;
    world.patches.push_back(dark);
    WorldModel model(world);
    Driver driver(model);
    double first_change = 0, last_change = 0;
    for (int i = 0; i < 1500; ++i) {
        driver.feed(500, 500);
        model.step();
        const double reading = model.robot(0).channels()[kGroundChannel + 1];
        const double place = model.state(0).x + 0.03;
        if (first_change == 0 && reading < 900) first_change = place;
        if (last_change == 0 && reading < 340) last_change = place;
    }
    CHECK(first_change == Approx(0.098).margin(0.0006));
    CHECK(last_change == Approx(0.102).margin(0.0006));
}

TEST_CASE("ground noise has its size and comes with the board's period") {
    WorldModel model(world_with_robot());
    double sum = 0, squares = 0, last = -1;
    int changes = 0;
    for (int i = 0; i < 10000; ++i) {
        model.step();
        const double value = model.robot(0).channels()[kGroundChannel];
        if (value != last) {
            ++changes;
            sum += value;
            squares += value * value;
        }
        last = value;
    }
    CHECK(changes == 1001);  // and one at the start
    const double mean = sum / changes;
    CHECK(mean == Approx(953).margin(0.3));  // 1000 samples: standard error 0.05, lean of the robot
    CHECK(std::sqrt(squares / changes - mean * mean) == Approx(1.5).margin(0.15));
}

TEST_CASE("the accelerometer feels gravity at rest and the start of motion") {
    WorldModel model(world_with_robot());
    Driver driver(model);
    driver.drive(0, 0, 1.0);
    const auto& c = model.robot(0).channels();
    CHECK(c[kAccelerationChannel] == Approx(2048).margin(2));
    CHECK(c[kAccelerationChannel + 1] == Approx(2048).margin(12));  // 0.4 deg of lean is 6 counts
    CHECK(c[kAccelerationChannel + 2] == Approx(2848).margin(2));
    double forward = 2048;
    for (int i = 0; i < 50; ++i) {
        driver.feed(800, 800);
        model.step();
        forward = std::min(forward, c[kAccelerationChannel + 1]);
    }
    CHECK(forward < 2048 - 200);  // forward is -y
}

TEST_CASE("the battery sags under load, runs down and signals when it is low") {
    World world = world_with_robot();
    WorldModel fresh(world);
    const double idle = fresh.robot(0).channels()[kBatteryVoltageChannel];
    CHECK(idle == Approx(4.03).margin(0.05));
    Driver driver(fresh);
    driver.drive(500, 500, 0.1);
    CHECK(fresh.robot(0).channels()[kBatteryVoltageChannel] < idle - 0.01);
    CHECK(fresh.robot(0).channels()[kBatteryLowChannel] == 0);
    world.parameters["battery.capacity"] = 0.001;  // 3.6 J: three seconds at 1.2 W
    WorldModel small(world);
    for (int i = 0; i < 3000; ++i)
        small.step();
    CHECK(small.robot(0).channels()[kBatteryLowChannel] == 1);
}

TEST_CASE("an LSM330 feels what the analogue accelerometer feels, in g, and how fast the robot turns") {
    World world = world_with_robot();
    world.robots[0].ground_signals["lsm330_acc_x"] = 15;
    WorldModel model(world);
    Driver driver(model);
    const auto& c = model.robot(0).channels();
    for (const auto& [left, right] : {std::pair{0.0, 0.0}, {500.0, 500.0}, {-300.0, 300.0}, {400.0, 100.0}}) {
        driver.drive(left, right, 0.5);
        const double heading = model.state(0).heading;
        double sum = 0;
        for (int i = 0; i < 500; ++i) {
            driver.feed(left, right);
            model.step();
            // Forward is -y, left is -x of the analogue one.
            CHECK(c[kForceChannel] == Approx((2048 - c[kAccelerationChannel + 1]) / 800).margin(1e-9));
            CHECK(c[kForceChannel + 1] == Approx((2048 - c[kAccelerationChannel]) / 800).margin(1e-9));
            CHECK(c[kForceChannel + 2] == Approx((c[kAccelerationChannel + 2] - 2048) / 800).margin(1e-9));
            sum += c[kTurnRateChannel + 2];
        }
        const double turned = std::remainder(model.state(0).heading - heading, 2 * std::acos(-1.0));
        CHECK(sum * kStepSeconds == Approx(turned * 180 / std::acos(-1.0)).margin(1e-6));
        CHECK((sum > 20) == (left < right));
    }
    WorldModel plain(world_with_robot());
    plain.step();
    CHECK(plain.robot(0).channels()[kForceChannel + 2] == 0);
}
