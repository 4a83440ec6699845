// What proximity readings get beside what is reflected: each against its own formula, taken from the
// difference to a run without it, which is the same in everything else.

#include "tests/physics/runs.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <numbers>

using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

constexpr std::size_t kSide = kProximityChannel + 2;  // looks to the right
constexpr std::size_t kFar = kProximityChannel + 5;   // to the left, where nothing is
constexpr double kSamples = 20000;                    // steps of a standing robot

/// Sensor 2 is 20 mm before the wall (384 counts and its offset of 60), the others see little.
World before_wall(double ambient = 1.0) {
    World world = world_with_robot(2, 1);
    world.robots[0].y = -0.5 + 0.031 + 0.02;
    world.ambient_light = ambient;
    world.seed = 77;
    return world;
}

std::vector<double> scatter(const World& world, const std::map<std::string, double>& parameters,
                            std::size_t channel, const Drive& drive = {0, 0, kSamples* kStepSeconds}) {
    return difference(run(with(world, parameters), drive), run(world, drive), channel, 200);
}

}  // namespace

TEST_CASE("neutral effects leave every channel as it is, bit by bit") {
    World world = before_wall();
    const Drive drive{310, 270, 1.5};
    const auto plain = run(world, drive);
    // What only shapes an effect that is off.
    const World shaped = with(world, {{"proximity.flicker_frequency", 7},
                                      {"proximity.interference_size", 900},
                                      {"proximity.interference_share", 0.4},
                                      {"proximity.still_noise", 50},
                                      {"ground.warmup_time", 20},
                                      {"accelerometer.warmup_time", 20}});
    CHECK(run(shaped, drive) == plain);
    // What draws from a stream of its own leaves the others alone.
    const auto noisy = run(with(world, {{"proximity.proportional_noise", 0.1},
                                        {"proximity.interference_rate", 0.1},
                                        {"accelerometer.vibration", 100}}),
                           drive);
    for (const std::size_t channel : {kAmbientChannel, kBatteryVoltageChannel, kGroundChannel})
        CHECK(difference(noisy, plain, channel) == std::vector<double>(plain.size(), 0.0));
}

TEST_CASE("noise in proportion has its share of the reading as its sd, each step anew") {
    const auto near = scatter(before_wall(), {{"proximity.proportional_noise", 0.05}}, kSide);
    const double sd = 0.05 * (383.84 + 60);
    CHECK(sd_of(near) == Approx(sd).epsilon(0.03));  // 6 standard errors of 20000
    CHECK(std::abs(mean_of(near)) < 0.05 * sd);
    CHECK(std::abs(carry_of(near)) < 0.04);
    CHECK(share_beyond(near, 2 * sd) == Approx(0.0455).margin(0.008));
    CHECK(sd_of(scatter(before_wall(), {{"proximity.proportional_noise", 0.05}}, kFar)) ==
          Approx(0.05 * 63).epsilon(0.03));
}

TEST_CASE("noise of room light grows with its root and is the same at every level") {
    for (const double ambient : {1.0, 0.36})
        for (const std::size_t channel : {kSide, kFar})
            CHECK(sd_of(scatter(before_wall(ambient), {{"proximity.ambient_noise", 12}}, channel)) ==
                  Approx(12 * std::sqrt(ambient)).epsilon(0.03));
    CHECK(sd_of(scatter(before_wall(0.0), {{"proximity.ambient_noise", 12}}, kFar, {0, 0, 1})) == 0);
}

TEST_CASE("motors add what makes the noise at rest grow by their share") {
    World world = world_with_robot(9, 9);
    world.seed = 5;
    const std::map<std::string, double> noise{{"proximity.motor_noise", 2.5}};
    const auto driving = scatter(world, noise, kFar, {400, 400, 12});
    CHECK(std::hypot(sd_of(driving), 2.83) == Approx(2.83 * (1 + 2.5 * 0.4)).epsilon(0.03));
    const auto turning = scatter(world, noise, kFar, {-600, 200, 12});
    CHECK(std::hypot(sd_of(turning), 2.83) == Approx(2.83 * (1 + 2.5 * 0.4)).epsilon(0.03));
    CHECK(sd_of(scatter(world, noise, kFar, {0, 0, 1})) == 0);
}

TEST_CASE("lamps flicker as a sine in light only, with a phase of the sensor's and the run's own") {
    const std::map<std::string, double> flicker{{"proximity.flicker", 20},
                                                {"proximity.flicker_frequency", 4}};
    const auto phase = [&](std::uint64_t seed, std::size_t channel = kSide) {
        World world = before_wall(0.5);
        world.seed = seed;
        const auto wave = scatter(world, flicker, channel, {0, 0, 2.2});  // 8 periods from 0.2 s on
        double sine = 0, cosine = 0;
        for (std::size_t k = 0; k < wave.size(); ++k) {
            const double angle = 2 * std::numbers::pi * 4 * (static_cast<double>(k) + 201) * kStepSeconds;
            sine += wave[k] * std::sin(angle) * 2 / static_cast<double>(wave.size());
            cosine += wave[k] * std::cos(angle) * 2 / static_cast<double>(wave.size());
        }
        CHECK(std::hypot(sine, cosine) == Approx(10).epsilon(1e-6));
        CHECK(sd_of(wave) == Approx(10 / std::numbers::sqrt2).epsilon(1e-6));  // nothing else in it
        return std::atan2(cosine, sine);
    };
    CHECK(phase(1) == Approx(phase(1)));
    CHECK(std::abs(phase(1) - phase(2)) > 0.01);
    CHECK(std::abs(phase(1) - phase(1, kFar)) > 0.01);
    CHECK(sd_of(scatter(before_wall(0.0), flicker, kSide, {0, 0, 1})) == 0);
}

TEST_CASE(
    "foreign pulses hit their share of the samples, up and down alike, with 0.3 of their size as scatter") {
    World world = before_wall();
    world.parameters["proximity.offset"] = 1000;
    const std::map<std::string, double> pulses{{"proximity.interference_rate", 0.1},
                                               {"proximity.interference_size", 200},
                                               {"proximity.interference_share3", 0.5},
                                               {"proximity.interference_share5", 0}};
    const auto hits = scatter(world, pulses, kSide);
    CHECK(share_beyond(hits, 0) == Approx(0.1).margin(0.01));
    CHECK(share_beyond(scatter(world, pulses, kProximityChannel + 3), 0) == Approx(0.05).margin(0.008));
    CHECK(share_beyond(scatter(world, pulses, kFar), 0) == 0);
    std::vector<double> sizes;
    double up = 0;
    for (const double hit : hits)
        if (hit != 0) {
            sizes.push_back(std::abs(hit));
            up += hit > 0 ? 1 : 0;
        }
    const double n = static_cast<double>(sizes.size());
    CHECK(up / n == Approx(0.5).margin(0.05));
    CHECK(mean_of(sizes) == Approx(200).epsilon(0.03));
    CHECK(sd_of(sizes) == Approx(60).epsilon(0.1));
}

TEST_CASE("noise comes before the dead zone and the converter's ends") {
    World world = before_wall();
    // 63 counts, cut below 70: what scatters above shows whole, the rest is nothing.
    const auto cut =
        run(with(world, {{"proximity.threshold", 70}, {"proximity.ambient_noise", 10}}), {0, 0, 5});
    double shown = 0;
    for (const auto& channels : cut) {
        CHECK((channels[kFar] == 0 || channels[kFar] >= 70));
        shown += channels[kFar] > 0 ? 1 : 0;
    }
    CHECK(shown / 5000 == Approx(0.242).margin(0.03));  // beyond 0.7 sd
    for (const auto& channels : run(with(world, {{"proximity.ambient_noise", 200}}), {0, 0, 1})) {
        CHECK(channels[kFar] >= 0);
        CHECK(channels[kFar] <= 4095);
    }
}

TEST_CASE("an aged reading is that of a while ago, with the gains of now") {
    World world = before_wall();
    world.robots[0].heading = -1.2;  // towards the wall, slantwise
    world.robots[0].y += 0.05;
    const Drive drive{300, 300, 1.0};
    const auto plain = run(world, drive);
    const auto aged = run(with(world, {{"proximity.age", 0.06}}), drive);
    const auto half = run(with(world, {{"proximity.age", 0.0605}}), drive);
    double most = 0;
    for (std::size_t k = 100; k < plain.size(); ++k)
        for (std::size_t sensor = 0; sensor < 8; ++sensor) {
            CHECK(aged[k][sensor] == plain[k - 60][sensor]);
            CHECK(half[k][sensor] == Approx((plain[k - 60][sensor] + plain[k - 61][sensor]) / 2));
            most = std::max(most, std::abs(aged[k][sensor] - plain[k][sensor]));
        }
    CHECK(most > 10);
    // Sag belongs to the motors of now: just after they stop, the reading is old and whole again.
    WorldModel model(with(world, {{"proximity.age", 0.06}, {"proximity.motor_sag", 0.1}}));
    Driver driver(model);
    driver.drive(300, 300, 0.5);
    driver.drive(0, 0, 0.03);
    CHECK(model.robot(0).channels()[0] == plain[530 - 60 - 1][0]);
    CHECK(plain[530 - 60 - 1][0] > 80);
    driver.drive(300, 300, 0.03);
    CHECK(model.robot(0).channels()[0] < 0.95 * plain[530 - 60 - 1][0]);
}
