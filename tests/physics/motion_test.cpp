// Motor steps to motion: geometry, slip, walls, pushing.

#include "tests/physics/worlds.h"

#include <catch2/catch.hpp>

#include <numbers>

using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {
constexpr double kPi = std::numbers::pi;
constexpr double kMetresPerStep = 2 * kPi * 0.0205 / 1000;
}  // namespace

TEST_CASE("a straight run is as long as its steps") {
    const double speed = GENERATE(100.0, 500.0, 993.0, -500.0);
    WorldModel world(world_with_robot(6, 2));
    Driver driver(world);
    driver.drive(speed, speed, 0.5);  // past the start
    const double x0 = world.state(0).x;
    const double steps0 = driver.steps(Side::Left);
    driver.drive(speed, speed, 4.0);
    const double moved = world.state(0).x - x0;
    const double asked = (driver.steps(Side::Left) - steps0) * kMetresPerStep;
    INFO("speed " << speed << " moved " << moved << " asked " << asked << " ratio " << moved / asked);
    CHECK(std::abs(moved / asked - 1) < 0.001);  // 0.1 mm of glide in 51 mm; required 0.002
    CHECK(std::abs(world.state(0).y) < 1e-4);
    CHECK(std::abs(world.state(0).heading) < 1e-4);
    CHECK(world.robot(0).drive(Side::Left).lost() == 0);
}

TEST_CASE("single steps move the robot too") {
    const double speed = GENERATE(10.0, 25.0, 48.0, -30.0);
    WorldModel world(world_with_robot());
    Driver driver(world);
    driver.drive(speed, speed, 6.0);
    const double asked = driver.steps(Side::Left) * kMetresPerStep;
    INFO("speed " << speed << " moved " << world.state(0).x << " asked " << asked);
    CHECK(std::abs(world.state(0).x - asked) < 1.5 * kMetresPerStep);  // the last step may be under way
}

TEST_CASE("a spin is as wide as by steps and axle") {
    const double speed = GENERATE(307.0, 993.0, -500.0);
    WorldModel world(world_with_robot());
    Driver driver(world);
    driver.drive(-speed, speed, 0.5);
    const double heading0 = world.state(0).heading;
    const double steps0 = driver.steps(Side::Right);
    driver.drive(-speed, speed, 4.0);
    const double turned = world.state(0).heading - heading0;
    const double asked = (driver.steps(Side::Right) - steps0) * kMetresPerStep * 2 / 0.053;
    INFO("speed " << speed << " turned " << turned << " asked " << asked << " ratio " << turned / asked);
    CHECK(std::abs(turned / asked - 1) < 0.001);  // required 0.005
    CHECK(std::hypot(world.state(0).x, world.state(0).y) < 1e-3);
}

TEST_CASE("an arc follows wheel radii and axle that were overridden") {
    auto description = world_with_robot();
    description.robots[0].parameters = {{"robot.wheel_radius_left", 0.0200},
                                        {"robot.wheel_radius_right", 0.0202},
                                        {"robot.axle_length", 0.052}};
    WorldModel world(description);
    Driver driver(world);
    driver.drive(400, 500, 0.5);
    const double heading0 = world.state(0).heading;
    const double left0 = driver.steps(Side::Left);
    const double right0 = driver.steps(Side::Right);
    driver.drive(400, 500, 3.0);
    const double asked =
        2 * kPi / 1000 *
        ((driver.steps(Side::Right) - right0) * 0.0202 - (driver.steps(Side::Left) - left0) * 0.0200) / 0.052;
    CHECK(world.state(0).heading - heading0 == Approx(asked).epsilon(0.005));
}

TEST_CASE("after the last step the robot stands where the steps lead, and stays") {
    WorldModel world(world_with_robot());
    Driver driver(world);
    driver.drive(300, 300, 1.0);
    driver.drive(0, 0, 0.5);
    const double x = world.state(0).x;
    CHECK(x == Approx(driver.steps(Side::Left) * kMetresPerStep).margin(0.5e-3));  // start and stop slip
    driver.drive(0, 0, 2.0);
    CHECK(world.state(0).x == Approx(x).margin(2e-5));
    CHECK(std::abs(world.state(0).pitch) < 0.02);
}

TEST_CASE("low friction costs distance at the start, as v^2 / (2 mu g)") {
    const auto lost_with = [](double mu) {
        auto description = world_with_robot(3, 2);
        description.parameters = {{"contact.mu", mu}, {"contact.mu_lateral", mu}, {"contact.mu_skid", 0.0}};
        WorldModel world(description);
        Driver driver(world);
        driver.drive(993, 993, 1.5);
        return driver.steps(Side::Left) * kMetresPerStep - world.state(0).x;
    };
    const double v = 993 * kMetresPerStep;
    // The rotor itself runs one step (0.13 mm) behind.
    for (const double mu : {0.05, 0.1, 0.2}) {
        INFO("mu " << mu);
        CHECK(lost_with(mu) - kMetresPerStep == Approx(v * v / (2 * mu * 9.81)).epsilon(0.05).margin(1e-4));
    }
}

TEST_CASE("a wall stops a robot at full speed, it neither passes nor climbs") {
    auto description = world_with_robot(1, 1);
    description.robots[0].heading = GENERATE(0.0, 0.4, kPi / 2, 2.5);
    WorldModel world(description);
    Driver driver(world);
    double deepest = 1.0;
    for (int i = 0; i < 10000; ++i) {
        driver.feed(1000, 1000);
        world.step();
        const auto& s = world.state(0);
        deepest = std::min(deepest, 0.5 - 0.035 - std::max(std::abs(s.x), std::abs(s.y)));
    }
    INFO("closest approach of the rim to the wall's face " << deepest);
    CHECK(deepest > -0.0005);  // half a millimetre of compliance
    CHECK(deepest < 0.001);
    CHECK(std::abs(world.state(0).pitch) < 0.1);
}

TEST_CASE("a robot that is held loses whole pole pairs and goes on when freed") {
    auto description = world_with_robot(1, 1);
    description.robots[0].x = 0.46;
    description.parameters["robot.stall_torque"] = 0.003;  // weaker than the tyres
    WorldModel world(description);
    Driver driver(world);
    driver.drive(200, 200, 3.0);
    const double lost = world.robot(0).drive(Side::Left).lost();
    CHECK(lost > 400);
    CHECK(std::fmod(lost, 4.0) == 0.0);
    driver.drive(-200, -200, 2.0);
    CHECK(world.state(0).x == Approx(0.465 - 400 * kMetresPerStep).margin(0.004));
}

TEST_CASE("a robot pushes another, and a box, and cannot push the fixed one") {
    World description;
    description.arena = rectangular_arena(2, 1);
    description.robots = {robot_at("pusher", -0.3, 0), robot_at("pushed", -0.1, 0)};
    Box light{.name = "light"};
    light.x = -0.3;
    light.y = 0.3;
    light.length = light.width = light.height = 0.05;
    light.movable = true;
    light.mass = 0.02;
    description.boxes.push_back(light);
    description.robots.push_back(robot_at("carrier", -0.45, 0.3));
    Cylinder post{.name = "post"};
    post.x = -0.1;
    post.y = -0.3;
    post.radius = 0.03;
    description.cylinders.push_back(post);
    description.robots.push_back(robot_at("blocked", -0.3, -0.3));
    WorldModel world(description);
    Driver pusher(world, 0), carrier(world, 2), blocked(world, 3);
    for (int i = 0; i < 3000; ++i) {
        pusher.feed(600, 600);
        carrier.feed(600, 600);
        blocked.feed(600, 600);
        world.step();
    }
    const double gap = world.state(1).x - world.state(0).x;
    INFO("gap " << gap << " pushed robot at " << world.state(1).x << " box at " << world.object(0).x);
    CHECK(gap > 0.0695);
    CHECK(world.object(0).x > -0.25);  // the box went along
    CHECK(world.object(0).x - world.state(2).x > 0.035 + 0.025 - 0.0005);
    CHECK(world.state(3).x < -0.1 - 0.03 - 0.035 + 0.0005);
}
