// Aggregation and follow-the-leader, step by step and as a small swarm of points that hear each other.

#include "linuxboard/control/behaviours/aggregate.h"
#include "linuxboard/control/behaviours/follow.h"
#include "linuxboard/control/behaviours/steering.h"
#include "linuxboard/control/control_loop.h"
#include "tests/linuxboard/simulated_line.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace puckloop::control;

namespace {

constexpr double kBody = 7.0;      // cm, diameter
constexpr double kHearing = 80.0;  // cm between surfaces
constexpr double kWheels = 5.3;    // cm between the wheels
constexpr double kStep = 0.1;      // s

struct Robot {
    int id = 0;
    double x = 0;  // cm
    double y = 0;
    double heading = 0;
    std::unique_ptr<Behaviour> behaviour;
    Actuators last;
};

double gap(const Robot& a, const Robot& b) {
    return std::hypot(a.x - b.x, a.y - b.y) - kBody;
}

/// What `self` perceives: every robot within hearing, and on its ring those within 4 cm.
Sensors sense(const Robot& self, const std::vector<Robot>& robots) {
    Sensors sensors;
    for (const Robot& other : robots) {
        if (other.id == self.id || gap(self, other) > kHearing) continue;
        const double bearing = wrapped(std::atan2(other.y - self.y, other.x - self.x) - self.heading);
        sensors.neighbours.push_back({other.id, other.last.say, bearing, std::max(0.0, gap(self, other)), 0});
        for (std::size_t i = 0; i < 8; ++i)
            if (gap(self, other) < 4 && std::abs(wrapped(kRingBearing[i] - bearing)) < 0.4)
                sensors.proximity[i] = 1000 * (1 - gap(self, other) / 4);
    }
    return sensors;
}

void run(std::vector<Robot>& robots, double duration) {
    for (double t = 0; t < duration; t += kStep) {
        std::vector<Actuators> next;
        for (Robot& robot : robots)
            next.push_back(robot.behaviour->step(sense(robot, robots), t));
        for (std::size_t i = 0; i < robots.size(); ++i) {
            Robot& robot = robots[i];
            robot.last = next[i];
            const double ahead = (next[i].left_mm_s + next[i].right_mm_s) / 20 * kStep;
            robot.heading += (next[i].right_mm_s - next[i].left_mm_s) / 10 / kWheels * kStep;
            robot.x += ahead * std::cos(robot.heading);
            robot.y += ahead * std::sin(robot.heading);
        }
    }
}

std::vector<Robot> swarm(const char* name, const std::vector<std::pair<double, double>>& places) {
    std::vector<Robot> robots;
    for (const auto& [x, y] : places) {
        const int id = static_cast<int>(robots.size()) + 1;
        robots.push_back({id, x, y, 0.7 * id, make_behaviour(name, id), {}});
    }
    return robots;
}

Sensors with(const Neighbour& neighbour) {
    Sensors sensors;
    sensors.neighbours.push_back(neighbour);
    return sensors;
}

}  // namespace

TEST_CASE("steering: turns towards a bearing, slows down when it is aside, wraps angles") {
    CHECK(drive_towards(0, 80).left_mm_s == 80);
    CHECK(drive_towards(0.5, 80).right_mm_s > drive_towards(0.5, 80).left_mm_s);
    CHECK(drive_towards(-2, 80).left_mm_s == -drive_towards(-2, 80).right_mm_s);
    CHECK(wrapped(4) == Approx(4 - 2 * M_PI));
    CHECK(led_towards(0) == 0x01);
    CHECK(led_towards(-M_PI / 2) == 0x04);  // right
    CHECK(led_towards(M_PI / 2) == 0x40);
    CHECK(led_towards(M_PI) == 0x10);
    CHECK(led_towards(0.1) == 0x01);
    CHECK(touches({0, 0, 0, 0, 0, 400, 0, 0}, 1.2));
    CHECK_FALSE(touches({0, 0, 0, 0, 0, 400, 0, 0}, -1.2));
}

TEST_CASE("aggregate approaches the neighbour heard, stops beside it, wanders alone") {
    Aggregate robot(1);
    CHECK(robot.step({}, 0).left_mm_s > 0);
    Actuators a = robot.step(with({2, 0, 1.0, 40, 0}), 0.1);
    CHECK(a.right_mm_s > a.left_mm_s);
    CHECK(a.say == 0);
    a = robot.step(with({2, 0, 0.0, 10, 0}), 0.2);
    CHECK(a.left_mm_s == 0);
    CHECK(a.right_mm_s == 0);
    CHECK(a.say == 1);
    CHECK(robot.in_group());
    robot.step(with({2, 0, 0.0, 18, 0}), 0.3);  // strength scatters
    CHECK(robot.in_group());
    robot.step(with({2, 0, 0.0, 25, 0}), 0.4);
    CHECK_FALSE(robot.in_group());
}

TEST_CASE("aggregate takes what it feels in a neighbour's direction for the neighbour") {
    Aggregate robot(1);
    robot.step({}, 0);
    Sensors s = with({2, 0, 0.3, 30, 0});
    s.proximity[7] = 900;  // 0.297 rad
    CHECK(robot.step(s, 0.1).left_mm_s == 0);
    CHECK(robot.in_group());
    s = with({2, 0, 3.0, 30, 0});  // a wall: the neighbour is behind
    s.proximity[7] = 900;
    const Actuators a = robot.step(s, 0.2);
    CHECK_FALSE(robot.in_group());
    CHECK(a.left_mm_s != 0);
}

TEST_CASE("aggregate leaves its group for a larger one, and for an equal one with a lower id") {
    for (const auto& [data, id, leaves] :
         {std::tuple{3U, 9, true}, {1U, 1, true}, {1U, 9, false}, {0U, 1, false}}) {
        Aggregate robot(5);
        Sensors s = with({6, 1, 2.0, 5, 0});
        robot.step(s, 0);
        s.neighbours.push_back({id, data, -1.0, 50, 0});
        robot.step(s, 0.1);
        CHECK(robot.in_group() == !leaves);
    }
}

TEST_CASE("two pairs that hear each other become one group") {
    auto robots = swarm("aggregate", {{0, 0}, {15, 0}, {60, 10}, {75, 10}});
    run(robots, 60);
    for (const Robot& robot : robots) {
        double nearest = 1e9;
        for (const Robot& other : robots)
            if (other.id != robot.id) nearest = std::min(nearest, gap(robot, other));
        CHECK(nearest < 20);
        CHECK(robot.last.left_mm_s == 0);
        CHECK(robot.last.right_mm_s == 0);
    }
    CHECK(gap(robots[0], robots[2]) < 30);
}

TEST_CASE("follow: the lowest id leads, the others form a chain behind it") {
    auto robots = swarm("follow", {{0, 0}, {-30, 10}, {-55, -10}});
    for (Robot& robot : robots)
        robot.heading = 0;
    run(robots, 20);
    const double led = robots[0].x;
    run(robots, 10);
    CHECK(robots[0].x > led + 20);
    CHECK(gap(robots[0], robots[1]) < 35);
    CHECK(gap(robots[1], robots[2]) < 35);
    CHECK(gap(robots[0], robots[1]) > 5);
    CHECK(gap(robots[1], robots[2]) > 5);
}

TEST_CASE("follow: keeps its distance, turns where it lost the leader, then leads on") {
    Follow robot(3);
    Sensors s;
    s.neighbours = {{1, 0, 2.0, 30, 0}, {2, 0, -0.5, 40, 0}, {9, 0, 1.0, 10, 0}};
    Actuators a = robot.step(s, 0);
    CHECK(a.left_mm_s > a.right_mm_s);  // after 2, which is on the right
    a = robot.step(with({2, 0, 0.0, 8, 0}), 0.1);
    CHECK(a.left_mm_s == 0);
    robot.step(with({2, 0, -1.0, 30, 0}), 0.2);
    a = robot.step({}, 0.3);
    CHECK(a.left_mm_s > 0);
    CHECK(a.right_mm_s == -a.left_mm_s);
    a = robot.step({}, 3.5);
    CHECK(a.left_mm_s > 0);
    CHECK(a.left_mm_s == a.right_mm_s);
}

TEST_CASE("the control loop gives behaviours their neighbours and passes on what they send") {
    SimulatedLine line(kOwnFirmware);
    line.sensors.battery_ok = 1;
    line.sensors.light.fill(3800);
    Session session(
        line, [](const std::string&) {}, [] { return false; });
    Aggregate behaviour(1);
    std::vector<std::uint32_t> said;
    Surroundings surroundings;
    surroundings.neighbours = [] { return std::vector<Neighbour>{{2, 0, 0.0, 5, 0}}; };
    surroundings.say = [&](std::uint32_t data) { said.push_back(data); };
    LoopSettings settings;
    settings.duration = 1;
    REQUIRE(run_control_loop(
        session, line, behaviour, surroundings, [] { return false; }, settings));
    CHECK(said == std::vector<std::uint32_t>(9, 1));  // the tenth record is rest
    CHECK(behaviour.in_group());
    CHECK(needs_neighbours("aggregate"));
    CHECK(needs_neighbours("follow"));
    CHECK_FALSE(needs_neighbours("wander"));
}
