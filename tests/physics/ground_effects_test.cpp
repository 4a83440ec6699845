// Lag, tilt at starts and warm-up of the ground row, each against its formula.

#include "tests/physics/runs.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

/// A floor that is black from x = 0.1 m on; the row is sampled each step, without noise.
World floor_with_edge() {
    World world = world_with_robot(2, 2);
    world.parameters = {{"ground.noise", 0}, {"ground.period", 0.001}};
    Patch dark{.name = "dark"};
    dark.x = 0.5;
    dark.length = 0.8;
    dark.width = 1.0;
    world.patches.push_back(dark);
    return world;
}

}  // namespace

TEST_CASE("a late row reads what lay under it then") {
    const World world = with(floor_with_edge(), {{"ground.height_slope", 0}});
    const Drive drive{500, 500, 1.5};
    const auto plain = run(world, drive);
    const auto late = run(with(world, {{"ground.lag", 0.12}}), drive);
    for (std::size_t k = 200; k < plain.size(); ++k)
        for (std::size_t i = 0; i < 3; ++i)
            CHECK(late[k][kGroundChannel + i] == Approx(plain[k - 120][kGroundChannel + i]));
    const auto changes = difference(late, plain, kGroundChannel);
    CHECK(*std::max_element(changes.begin(), changes.end()) > 500);
}

TEST_CASE("the nose lifts by the acceleration over the last 0.1 s") {
    constexpr double kTilt = 0.1, kPeriod = 0.01;  // rad s2/m, s
    World world = world_with_robot(3, 3);
    world.parameters = {{"ground.noise", 0},
                        {"ground.period", kPeriod},
                        {"ground.acceleration_tilt", kTilt},
                        {"ground.white", 600}};
    WorldModel model(world);
    Driver driver(model);
    std::vector<double> speeds(10, 0.0);  // 0.1 s of rest before the start
    double most = 0;
    for (int sample = 0; sample < 60; ++sample) {
        const double steps = sample < 30 ? 600 : 0;
        driver.drive(steps, steps, kPeriod);
        const auto& state = model.state(0);
        speeds.push_back(state.velocity[0]);
        const double acceleration = (speeds.back() - speeds[speeds.size() - 11]) / 0.1;
        const double lift = 0.03 * std::sin(kTilt * acceleration - state.pitch);  // nose up
        const double signal = std::clamp(1 - 43.75 * lift, 0.05, 1.2);
        CHECK(model.robot(0).channels()[kGroundChannel + 1] ==
              Approx(600 * signal).margin(0.1));  // the floor is looked at again after 5e-5 rad
        most = std::max(most, std::abs(600 * (1 - signal)));
    }
    CHECK(most > 40);
}

TEST_CASE("ground sensors warm up, gains and levels with them but not the offset") {
    const std::map<std::string, double> warm{{"ground.warmup_gain", -0.2}, {"ground.warmup_time", 2}};
    const World world = with(floor_with_edge(), {{"ground.offset", 30}, {"ground.gain", 0.8}});
    const auto plain = run(world, {0, 0, 3});
    const auto drifted = run(with(world, warm), {0, 0, 3});
    for (const std::size_t k : {99u, 999u, 2999u}) {
        const double seconds = (static_cast<double>(k) + 1) * kStepSeconds;
        for (std::size_t i = 0; i < 3; ++i)
            CHECK(drifted[k][kGroundChannel + i] - 30 ==
                  Approx((plain[k][kGroundChannel + i] - 30) * (1 - 0.2 * (1 - std::exp(-seconds / 2)))));
    }
}
