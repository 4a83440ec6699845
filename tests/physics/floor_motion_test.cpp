// How the floor moves under a robot, alone and under a robot that drives on it.

#include "tests/physics/worlds.h"

#include <catch2/catch.hpp>

#include <numbers>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kMetresPerStep = 2 * kPi * 0.0205 / 1000;
constexpr double kAxle = 0.053;
using Values = std::map<std::string, double>;

FloorMotion motion_with(const Values& values) {
    Parameters parameters;
    for (const auto& [name, value] : values)
        parameters.set(name, value);
    return {parameters, RandomStream(7, "pushes")};
}

/// A leg of a drive, steps/s and s.
struct Leg {
    double left, right, seconds;
};

RobotState after(const Values& values, const std::vector<Leg>& legs, double heading = 0.0) {
    auto description = world_with_robot(6, 6);
    description.robots[0].heading = heading;
    description.parameters = values;
    WorldModel world(description);
    Driver driver(world);
    for (const Leg& leg : legs)
        driver.drive(leg.left, leg.right, leg.seconds);
    driver.drive(0, 0, 0.5);
    return world.state(0);
}

/// What one drive loses when `values` hold, of what it makes without them.
double share_lost(const Values& values, const std::vector<Leg>& legs, double heading = 0.0) {
    Values slope;  // holds in both
    for (const auto& [name, value] : values)
        if (name.starts_with("world.") || name == "robot.load") slope[name] = value;
    const auto with = after(values, legs, heading), without = after(slope, legs, heading);
    return 1 - std::hypot(with.x, with.y) / std::hypot(without.x, without.y);
}

}  // namespace

TEST_CASE("a floor that nobody asked to move is still") {
    CHECK(motion_with({}).still());
    CHECK(motion_with({{"robot.load", 0.3}, {"world.slope_x", 0.1}, {"push.size", 0.1}}).still());
    CHECK(motion_with({{"robot.load_creep", 0.3}, {"robot.slope_creep", 0.1}}).still());
    CHECK_FALSE(motion_with({{"robot.turn_scrub", 0.01}}).still());
    CHECK_FALSE(motion_with({{"robot.load_creep", 0.1}, {"robot.load", 0.1}}).still());
    CHECK_FALSE(motion_with({{"robot.slope_creep", 0.1}, {"world.slope_y", 0.1}}).still());
    CHECK_FALSE(motion_with({{"robot.drift_y", -0.001}}).still());
    CHECK_FALSE(motion_with({{"push.rate", 0.1}}).still());
}

TEST_CASE("disturbances come at their rate and with their size, and move the floor by as much") {
    auto floor = motion_with({{"push.rate", 0.5}, {"push.size", 0.02}, {"push.turn", 0.2}});
    constexpr int kSeconds = 2000;
    std::array<double, 3> moved{}, last{};
    double squares = 0.0, turns = 0.0;
    int seen = 0, moving = 0;
    for (int ms = 1; ms <= kSeconds * 1000; ++ms) {
        const auto v = floor.velocity({.seconds = ms * 1e-3}, 1e-3);
        const std::array<double, 3> now{v.x, v.y, v.turn};
        moving += now == std::array<double, 3>{} ? 0 : 1;
        for (std::size_t i = 0; i < 3; ++i)
            moved[i] += now[i] * 1e-3;
        if (floor.pushes() == seen) continue;
        seen = floor.pushes();
        const auto& all = floor.pushed();
        squares += std::pow(all[0] - last[0], 2) + std::pow(all[1] - last[1], 2);
        turns += std::pow(all[2] - last[2], 2);
        last = all;
    }
    CHECK(floor.pushes() == Approx(0.5 * kSeconds).margin(100));  // 3 standard deviations
    CHECK(std::sqrt(squares / seen / 2) == Approx(0.02).epsilon(0.1));
    CHECK(std::sqrt(turns / seen) == Approx(0.2).epsilon(0.1));
    CHECK(moving / static_cast<double>(seen) == Approx(50).margin(1));  // ms a push
    for (std::size_t i = 0; i < 3; ++i)
        CHECK(moved[i] == Approx(last[i]).margin(1e-3));  // the last one may be under way
}

TEST_CASE("a robot that stands is taken where pushes take it") {
    auto description = world_with_robot(4, 4);
    description.parameters = {{"push.rate", 0.3}, {"push.size", 0.02}, {"push.turn", 0.2}};
    WorldModel world(description);
    double x = 0.0, y = 0.0, heading = 0.0;
    int seen = 0;
    for (int ms = 0; ms < 30000; ++ms) {
        world.step();
        const auto& floor = world.robot(0).floor_motion();
        if (floor.pushes() == seen) continue;
        seen = floor.pushes();
        x = floor.pushed()[0];
        y = floor.pushed()[1];
        heading = floor.pushed()[2];
    }
    for (int ms = 0; ms < 300; ++ms)
        world.step();
    REQUIRE(seen > 3);
    REQUIRE(world.robot(0).floor_motion().pushes() == seen);
    CHECK(world.state(0).x == Approx(x).margin(0.001));
    CHECK(world.state(0).y == Approx(y).margin(0.001));
    CHECK(world.state(0).heading == Approx(heading).margin(0.02));
    CHECK(std::hypot(x, y) > 0.01);
}

TEST_CASE("a push against a wall does not go through it") {
    auto description = world_with_robot(0.08, 0.08);
    description.parameters = {{"push.rate", 1}, {"push.size", 0.05}};
    WorldModel world(description);
    double furthest = 0.0;
    for (int ms = 0; ms < 20000; ++ms) {
        world.step();
        furthest = std::max({furthest, std::abs(world.state(0).x), std::abs(world.state(0).y)});
    }
    CHECK(world.robot(0).floor_motion().pushes() > 10);
    CHECK(furthest < 0.005 + 0.003);  // of a millisecond at 3 m/s
    CHECK(furthest > 0.004);
    CHECK(std::abs(world.state(0).x) < 0.0055);
    CHECK(std::abs(world.state(0).y) < 0.0055);
}

TEST_CASE("tyres that scrub turn less, the tighter the turn the more") {
    const Values scrub{{"robot.turn_scrub", 0.06}};
    const std::vector<Leg> spin{{-300, 300, 4}}, arc{{300, 500, 4}}, line{{500, 500, 4}}, pivot{{0, -400, 4}};
    const auto ratio = [&](const std::vector<Leg>& legs) {
        return after({}, legs).heading / after(scrub, legs).heading - 1;
    };
    CHECK(ratio(spin) == Approx(0.06).epsilon(0.02));
    CHECK(ratio(pivot) == Approx(0.06 / 2).epsilon(0.02));
    CHECK(ratio(arc) == Approx(0.06 * 100 / (400 + 100)).epsilon(0.02));
    const auto with = after(scrub, line), without = after({}, line);
    CHECK(with.x == Approx(without.x).margin(1e-6));
    CHECK(with.heading == Approx(0).margin(1e-6));
}

TEST_CASE("a load costs its share of the way, both ways and in turns") {
    const Values creep{{"robot.load", 0.2}, {"robot.load_creep", 0.1}};
    CHECK(share_lost(creep, {{450, 450, 4}}) == Approx(0.02).epsilon(0.02));
    CHECK(share_lost(creep, {{-450, -450, 4}}) == Approx(0.02).epsilon(0.02));
    const auto with = after(creep, {{-300, 300, 4}}),
               without = after({{"robot.load", 0.2}}, {{-300, 300, 4}});
    CHECK(1 - with.heading / without.heading == Approx(0.02).epsilon(0.02));
}

TEST_CASE("a creep that takes more than all of the way leaves the robot where it is") {
    const Values creep{
        {"robot.load", 1}, {"robot.load_creep", 1}, {"world.slope_x", 0.1}, {"robot.slope_creep", 1}};
    const auto with = after(creep, {{300, 300, 4}});
    CHECK(std::hypot(with.x, with.y) < 0.003);
}

TEST_CASE("a load alone leaves the way as it is") {
    const std::vector<Leg> legs{{450, 450, 4}, {0, 0, 0.5}, {-200, 300, 2}};
    const auto with = after({{"robot.load", 0.2}}, legs), without = after({}, legs);
    CHECK(with.x == Approx(without.x).margin(5e-4));
    CHECK(with.heading == Approx(without.heading).margin(5e-3));
}

TEST_CASE("a slope costs way uphill, gives some with the nose downhill, and none along the contour") {
    const Values creep{{"world.slope_x", 0.1}, {"robot.slope_creep", 0.3}};
    CHECK(share_lost(creep, {{450, 450, 4}}, 0.0) == Approx(0.03).epsilon(0.03));
    CHECK(share_lost(creep, {{450, 450, 4}}, kPi) == Approx(-0.03).epsilon(0.03));
    CHECK(share_lost(creep, {{450, 450, 4}}, kPi / 2) == Approx(0).margin(0.001));
    CHECK(share_lost(creep, {{450, 450, 4}}, kPi / 3) == Approx(0.015).epsilon(0.05));
}

TEST_CASE("a drift acts in the world's axes while the wheels are driven, however slowly") {
    const Values drift{{"robot.drift_x", 0.003}, {"robot.drift_y", -0.002}};
    const double speed = GENERATE(20.0, 300.0);
    const double heading = 1.0;
    const auto with = after(drift, {{speed, speed, 5}}, heading),
               without = after({}, {{speed, speed, 5}}, heading);
    // It ends some 20 ms after the last fast step, or when the next slow one is overdue: 75 ms.
    CHECK(with.x - without.x == Approx(5 * 0.003).margin(3e-4));
    CHECK(with.y - without.y == Approx(-5 * 0.002).margin(3e-4));
    CHECK(with.heading == Approx(without.heading).margin(2e-3));
    const auto standing = after(drift, {{0, 0, 5}});
    CHECK(std::hypot(standing.x, standing.y) < 1e-5);
}

TEST_CASE("a fast motor loses the share of its steps that the law says, both ways") {
    // 1 / (1 + exp((865 - v) / 95)) of the steps, in groups of four: of 8000 that scatters by 1.3 %.
    const Values loss{{"robot.step_loss_speed", 865}, {"robot.step_loss_width", 95}};
    const double speed = GENERATE(700.0, 865.0, 950.0, -900.0);
    const double share = 1 / (1 + std::exp((865 - std::abs(speed)) / 95));
    CHECK(share_lost(loss, {{speed, speed, 10}}) == Approx(share).margin(0.04));
    CHECK(share_lost(loss, {{300, 300, 5}}) < 0.02);
}

TEST_CASE("a motor that loses steps stands meanwhile and is not thrown back") {
    Parameters parameters;
    parameters.robot.step_loss_speed = 900;
    parameters.robot.step_loss_width = 50;
    WheelDrive wheel(parameters.robot, RandomStream(3, "losses"));
    double last = 0.0;
    for (int k = 1; k <= 4000; ++k) {
        const double now = 1.0 + k / 900.0;
        wheel.step_to(k, now);
        const double next = wheel.angle(now + 0.5 / 900);
        CHECK(next >= last - 1e-12);
        last = next;
    }
    CHECK(wheel.lost() == Approx(2000).margin(4 * 4 * std::sqrt(4000 / 8.0)));  // four standard deviations
}

TEST_CASE("steps slower than the dead band leave the wheel, faster ones turn it") {
    const Values band{{"robot.deadband", 60}};
    const double slow = GENERATE(10.0, 40.0, 59.0);
    CHECK(std::abs(after(band, {{slow, -slow, 4}}).heading) < 2.1 * kMetresPerStep / kAxle);  // they lean
    const auto with = after(band, {{65, 65, 4}}), without = after({}, {{65, 65, 4}});
    CHECK(with.x == Approx(without.x).margin(1e-6));  // the first step, too
    CHECK(with.x > 4 * 60 * kMetresPerStep);
    CHECK(after(band, {{600, 600, 1}}).x == Approx(after({}, {{600, 600, 1}}).x).margin(1e-6));
}

TEST_CASE("of steps that are too slow only the last one is followed") {
    Parameters parameters;
    parameters.robot.deadband = 60;
    WheelDrive wheel(parameters.robot, RandomStream(1, "losses"));
    const auto at = [&](double seconds) { return wheel.angle(seconds) / (2 * kPi / 1000); };
    wheel.step_to(1, 1.0);  // after standing: nobody knows yet
    CHECK(at(1.009) == Approx(1));
    wheel.step_to(2, 1.01);  // 100 steps/s
    CHECK(at(1.1) == Approx(2));
    for (int k = 3; k <= 12; ++k)
        wheel.step_to(k, 0.9 + 0.1 * k);
    CHECK(at(2.15) == Approx(3));
    CHECK(wheel.lost() == 9);
    wheel.step_to(13, 2.11);  // on, fast
    CHECK(at(2.2) == Approx(4));
    for (int k = 12; k >= 8; --k)
        wheel.step_to(k, 3.5 - 0.1 * k);
    CHECK(at(3) == Approx(3));
    wheel.step_to(9, 2.71);  // fast the other way
    CHECK(at(3) == Approx(4));
    CHECK(wheel.lost() == 5);
}
