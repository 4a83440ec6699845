// The overhead tracker: when its frames are, and how wrong they are.

#include "physics/tracker/tracker.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace puckloop;
using namespace puckloop::physics;

namespace {

const std::vector<Point> kSquare{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};

std::vector<RobotState> robots_at(std::initializer_list<Point> places) {
    std::vector<RobotState> robots;
    for (const Point& place : places)
        robots.push_back({.x = place.x, .y = place.y, .heading = 1.0});
    return robots;
}

std::vector<TrackerFrame> frames_of(const TrackerSpec& spec, const std::vector<RobotState>& robots,
                                    std::uint64_t steps, std::uint64_t seed = 1) {
    Tracker tracker(spec, kSquare, seed, robots.size());
    std::vector<TrackerFrame> frames;
    for (std::uint64_t step = 0; step <= steps; ++step)
        if (tracker.due(step)) frames.push_back(tracker.see(step, robots));
    return frames;
}

TrackerSpec exact() {
    TrackerSpec spec;
    spec.position_noise = spec.heading_noise = 0.0;
    return spec;
}

}  // namespace

TEST_CASE("a tracker's frames are due by its rate, in whole steps, and no error adds up") {
    TrackerSpec spec = exact();
    spec.frame_rate = 30.0;
    spec.latency = 0.04;
    const auto frames = frames_of(spec, robots_at({{0, 0}}), 100'000);
    REQUIRE(frames.size() == 3001);
    CHECK(frames[1].step == 34);
    CHECK(frames[3].step == 100);
    CHECK(frames[3000].step == 100'000);
    CHECK(frames[3].arrives == 140);
    CHECK(frames[3].number == 3);
}

TEST_CASE("a tracker without noise sees robots where they are, headings within half a turn") {
    auto robots = robots_at({{0.1, -0.2}});
    robots[0].heading = 5 * std::numbers::pi / 2;
    const auto frames = frames_of(exact(), robots, 0);
    REQUIRE(frames.at(0).robots.size() == 1);
    CHECK(frames[0].robots[0].x == 0.1);
    CHECK(frames[0].robots[0].y == -0.2);
    CHECK(frames[0].robots[0].heading == Approx(std::numbers::pi / 2));
}

TEST_CASE("a tracker's noise has the standard deviations that it states") {
    TrackerSpec spec;
    spec.frame_rate = 1000.0;
    spec.position_noise = 0.004;
    spec.heading_noise = 0.05;
    double xx = 0.0, hh = 0.0, xy = 0.0;
    const auto frames = frames_of(spec, robots_at({{0, 0}}), 20'000);
    for (const TrackerFrame& frame : frames) {
        const TrackedRobot& robot = frame.robots.at(0);
        xx += robot.x * robot.x;
        xy += robot.x * robot.y;
        hh += (robot.heading - 1.0) * (robot.heading - 1.0);
    }
    const auto n = static_cast<double>(frames.size());
    CHECK(std::sqrt(xx / n) == Approx(0.004).epsilon(0.02));  // four standard errors
    CHECK(std::sqrt(hh / n) == Approx(0.05).epsilon(0.02));
    CHECK(std::abs(xy / n) < 4 * 0.004 * 0.004 / std::sqrt(n));
}

TEST_CASE("a tracker loses robots as often and as long as it states, more of them at the edge") {
    TrackerSpec spec = exact();
    spec.frame_rate = 100.0;
    spec.loss = 0.02;
    spec.edge_loss = 0.2;
    spec.loss_time = 0.1;
    double seen[2]{}, losses[2]{}, missed[2]{};
    bool before[2]{true, true};
    for (const TrackerFrame& frame : frames_of(spec, robots_at({{0, 0}, {0.95, 0}}), 1'000'000)) {
        bool now[2]{};
        for (const TrackedRobot& robot : frame.robots)
            now[robot.robot] = true;
        for (std::size_t i = 0; i < 2; ++i) {
            seen[i] += before[i] ? 1 : 0;
            losses[i] += before[i] && !now[i] ? 1 : 0;
            missed[i] += now[i] ? 0 : 1;
            before[i] = now[i];
        }
    }
    CHECK(losses[0] / seen[0] == Approx(0.02).epsilon(0.1));
    CHECK(losses[1] / seen[1] == Approx(0.2).epsilon(0.05));
    // A lost robot is found again with 1 - exp(-T / loss_time) a frame: 1 / that frames, 10.5 here.
    CHECK(missed[0] / losses[0] == Approx(1.0 / (1.0 - std::exp(-0.1))).epsilon(0.1));
}

TEST_CASE("a tracker takes near robots for each other, and goes on so until it does it again") {
    TrackerSpec spec = exact();
    spec.swap = 0.01;
    const auto robots = robots_at({{0, 0}, {0.09, 0}, {0.5, 0}});
    std::size_t swaps = 0, frames = 0;
    bool swapped = false;
    for (const TrackerFrame& frame : frames_of(spec, robots, 2'000'000)) {
        REQUIRE(frame.robots.size() == 3);
        const bool now = frame.robots[0].x != 0.0;
        CHECK(frame.robots[now ? 1 : 0].x == 0.0);
        CHECK(frame.robots[2].x == 0.5);  // too far from both
        swaps += now != swapped ? 1 : 0;
        swapped = now;
        ++frames;
    }
    CHECK(static_cast<double>(swaps) / static_cast<double>(frames) == Approx(0.01).epsilon(0.25));
}

TEST_CASE("losing a robot moves nobody's noise, and another seed is another noise") {
    TrackerSpec spec, losing;
    losing.loss = 0.5;
    const auto robots = robots_at({{0, 0}, {0.3, 0.1}});
    const auto all = frames_of(spec, robots, 5000, 7), some = frames_of(losing, robots, 5000, 7),
               other = frames_of(spec, robots, 5000, 8);
    REQUIRE(all.size() == some.size());
    std::size_t fewer = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        fewer += all[i].robots.size() - some[i].robots.size();
        for (const TrackedRobot& robot : some[i].robots)
            CHECK(robot.x == all[i].robots[robot.robot].x);
    }
    CHECK(fewer > 0);
    CHECK(other[3].robots[0].x != all[3].robots[0].x);
}
