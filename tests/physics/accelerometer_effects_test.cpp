// Scales, turn, sag, warm-up, vibration and a session's zeros of the accelerometer, each against its formula.

#include "tests/physics/runs.h"

#include <catch2/catch.hpp>

using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

constexpr double kZero = 2048;

World slope() {
    World world = world_with_robot(9, 9);
    world.parameters = {{"world.slope_x", 0.12}, {"world.slope_y", -0.07}};
    world.seed = 31;
    return world;
}

double axis(const std::vector<Channels>& all, std::size_t step, std::size_t index) {
    return all[step][kAccelerationChannel + index];
}

}  // namespace

TEST_CASE("each axis has a scale, and the chip may be turned on its board") {
    const Drive drive{200, 260, 0.5};
    const auto plain = run(slope(), drive);
    const auto scaled = run(
        with(slope(),
             {{"accelerometer.scale0", 1.1}, {"accelerometer.scale1", 0.9}, {"accelerometer.scale2", 1.2}}),
        drive);
    const auto turned = run(with(slope(), {{"accelerometer.turn", 0.3}}), drive);
    const double c = std::cos(0.3), s = std::sin(0.3);
    for (const std::size_t k : {0u, 20u, 70u, 499u}) {
        const double right = axis(plain, k, 0) - kZero, rear = axis(plain, k, 1) - kZero;
        CHECK(axis(scaled, k, 0) - kZero == Approx(1.1 * right));
        CHECK(axis(scaled, k, 1) - kZero == Approx(0.9 * rear));
        CHECK(axis(scaled, k, 2) - kZero == Approx(1.2 * (axis(plain, k, 2) - kZero)));
        CHECK(axis(turned, k, 0) - kZero == Approx(c * right + s * rear));
        CHECK(axis(turned, k, 1) - kZero == Approx(c * rear - s * right));
        CHECK(axis(turned, k, 2) == axis(plain, k, 2));
    }
    CHECK(std::abs(axis(plain, 499, 1) - kZero) > 50);  // there is something to turn
}

TEST_CASE("motors that step take their share of the whole value, zero included") {
    const std::map<std::string, double> sag{{"accelerometer.motor_sag", 0.03}};
    for (const auto& [drive, share] :
         {std::pair{Drive{300, 300, 0.4}, 0.03}, {Drive{0, 300, 0.4}, 0.015}, {Drive{0, 0, 0.4}, 0.0}}) {
        const auto plain = run(slope(), drive), sagged = run(with(slope(), sag), drive);
        for (std::size_t i = 0; i < 3; ++i)
            CHECK(axis(sagged, 399, i) == Approx(axis(plain, 399, i) * (1 - share)));
    }
}

TEST_CASE("the accelerometer's zero drifts while it warms up") {
    const auto plain = run(slope(), {0, 0, 2});
    const auto warm =
        run(with(slope(), {{"accelerometer.warmup", 60}, {"accelerometer.warmup_time", 1.5}}), {0, 0, 2});
    for (const std::size_t k : {99u, 1999u})
        for (std::size_t i = 0; i < 3; ++i)
            CHECK(axis(warm, k, i) - axis(plain, k, i) ==
                  Approx(60 * (1 - std::exp(-(static_cast<double>(k) + 1) * kStepSeconds / 1.5))));
}

TEST_CASE("vibration has an sd in proportion to the motors' speed, each step anew on each axis") {
    const std::map<std::string, double> shaking{{"accelerometer.vibration", 60}};
    for (const auto& [drive, speed] :
         {std::pair{Drive{500, 500, 10}, 500.0}, {Drive{-200, 100, 10}, 150.0}}) {
        const auto plain = run(slope(), drive), shaken = run(with(slope(), shaking), drive);
        for (std::size_t i = 0; i < 3; ++i) {
            const auto noise = difference(shaken, plain, kAccelerationChannel + i, 500);
            const double sd = 60 * speed / 1000;
            CHECK(sd_of(noise) == Approx(sd).epsilon(0.04));  // 9500 samples, single steps of the motors
            CHECK(std::abs(mean_of(noise)) < 0.06 * sd);
            CHECK(std::abs(carry_of(noise)) < 0.05);
            CHECK(share_beyond(noise, 2 * sd) == Approx(0.0455).margin(0.012));
        }
    }
    const auto rest =
        difference(run(with(slope(), shaking), {0, 0, 0.5}), run(slope(), {0, 0, 0.5}), kAccelerationChannel);
    CHECK(rest == std::vector<double>(500, 0.0));
}
