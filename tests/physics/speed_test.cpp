// How long a robot's millisecond takes. Hidden: run with `physics_tests "[speed]"`.

#include "tests/physics/worlds.h"

#include <catch2/catch.hpp>

#include <cstdio>
#include <ctime>
#include <deque>

using namespace puckloop::physics;
using namespace puckloop::physics::test;

TEST_CASE("microseconds a robot and millisecond", "[.speed]") {
    for (const int count : {1, 10, 20, 50}) {
        World world;
        world.arena = rectangular_arena(3, 3);
        world.lamps.push_back({.name = "lamp", .x = 1, .y = 1});
        for (int i = 0; i < 8; ++i) {
            world.boxes.push_back({.name = "box" + std::to_string(i), .x = -1.2 + 0.34 * i, .y = 1.2});
            world.cylinders.push_back({.name = "can" + std::to_string(i), .x = -1.2 + 0.34 * i, .y = -1.2});
        }
        for (int i = 0; i < count; ++i)
            world.robots.push_back(
                robot_at("e" + std::to_string(i), -1 + 0.2 * (i % 10), -0.6 + 0.25 * (i / 10), i));
        WorldModel model(world);
        std::deque<Driver> drivers;
        for (int i = 0; i < count; ++i)
            drivers.emplace_back(model, static_cast<std::size_t>(i));
        const int steps = 20000 / count;
        const std::clock_t begun = std::clock();  // processor time: other work does not count
        for (int k = 0; k < steps; ++k) {
            for (int i = 0; i < count; ++i)
                drivers[static_cast<std::size_t>(i)].feed(300, 340 + i);
            model.step();
        }
        const double us = 1e6 * static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
        std::printf("%d robots: %.2f us a robot-step\n", count, us / steps / count);
    }
}
