// Effects that a run has by parameters of the same name: what the world model's sensors do with them is what
// the forward models say. Means, and the sizes of scatter over many samples.

#include "tests/gap/models/made_table.h"
#include "tests/physics/runs.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::gap;
using namespace puckloop::gap::tests;
namespace worlds = puckloop::physics::test;

namespace {

using Changes = std::map<std::string, double>;
constexpr std::size_t kSide = physics::kProximityChannel + 2;
constexpr double kGap = 0.02;  // m from sensor 2 to a wall
constexpr double kAmbient = 0.7;

physics::World before_wall() {
    physics::World world = worlds::world_with_robot(4, 1);
    world.robots[0].y = -0.5 + 0.031 + kGap;
    world.ambient_light = kAmbient;
    world.seed = 9;
    return world;
}

/// Two rows of sensor 2 there, at rest and driving along the wall.
Table two_rows(double speed) {
    return {{"t_s", {0, 1}},
            {"sensor", {2, 2}},
            {"distance_m", {kGap, kGap}},
            {"reading", {400, 410}},
            {"ambient", {kAmbient, kAmbient}},
            {"motor_speed", {0, speed}}};
}

/// Scatter that parameters add in the world, without the board's own.
double world_sd(const Changes& changes, const worlds::Drive& drive) {
    const physics::World plain = before_wall();
    return worlds::sd_of(worlds::difference(worlds::run(worlds::with(plain, changes), drive),
                                            worlds::run(plain, drive), kSide, 500));
}

}  // namespace

TEST_CASE("proximity scatter in the world has the size that the forward model gives it") {
    constexpr double kStill = 2.83, kSpeed = 300;
    const Experiment experiment = experiment_of(Kind::Proximity, two_rows(kSpeed));
    const auto model = make_model(experiment);
    for (const Changes& changes :
         {Changes{{"proximity.proportional_noise", 0.033}}, Changes{{"proximity.ambient_noise", 8}},
          Changes{{"proximity.ambient_noise", 8}, {"proximity.proportional_noise", 0.033}}}) {
        const Prediction said = predicted(*model, changes);
        CHECK(world_sd(changes, {0, 0, 10}) == Approx(said[0].extra[0]).epsilon(0.04));
    }
    const Changes motors{{"proximity.motor_noise", 2.5}};
    const Prediction said = predicted(*model, motors);
    CHECK(said[0].factor[0] == 1);
    CHECK(std::hypot(world_sd(motors, {kSpeed, kSpeed, 10}), kStill) ==
          Approx(kStill * said[0].factor[1]).epsilon(0.04));
}

TEST_CASE("foreign pulses in the world come as often and as large as the forward model's lapses") {
    const Changes pulses{{"proximity.interference_rate", 0.08}, {"proximity.interference_size", 100}};
    const Experiment experiment = experiment_of(Kind::Proximity, two_rows(0));
    const Prediction said = predicted(*make_model(experiment), pulses);
    const physics::World plain = before_wall();
    const auto hits = worlds::difference(worlds::run(worlds::with(plain, pulses), {0, 0, 20}),
                                         worlds::run(plain, {0, 0, 20}), kSide);
    std::vector<double> sizes;
    for (const double hit : hits)
        if (hit != 0.0) sizes.push_back(std::abs(hit));
    CHECK(static_cast<double>(sizes.size()) / 20000 == Approx(said[0].lapse[0]).epsilon(0.1));
    CHECK(worlds::mean_of(sizes) == Approx(said[0].lapse_shift[0]).epsilon(0.03));
    CHECK(worlds::sd_of(sizes) == Approx(said[0].lapse_scale[0]).epsilon(0.1));
    CHECK(said[0].lapse_both);
    CHECK(std::abs(worlds::mean_of(hits)) < 1);
}

TEST_CASE("a lamp in the world swings by the forward model's amplitude") {
    const Changes lamp{{"proximity.flicker", 10}, {"proximity.flicker_frequency", 5}};
    const Experiment experiment = experiment_of(Kind::Proximity, two_rows(0));
    const auto model = make_model(experiment);
    const Prediction said = predicted(*model, lamp);
    const double amplitude = said[0].line_amplitude * model->observables()[0].gate[0];
    CHECK(world_sd(lamp, {0, 0, 2.5}) == Approx(amplitude / std::sqrt(2)).epsilon(1e-3));
}

TEST_CASE("an age in the world is the forward model's at a steady approach") {
    physics::World world = before_wall();
    world.robots[0].heading = -1.2708;  // sensor 0 looks straight at the wall
    world.robots[0].y = -0.5 + 0.1;
    const double fast = 400, rate = 400 * 1.288053e-4 * std::sin(1.2708);
    const Changes age{{"proximity.age", 0.05}};
    const auto aged = worlds::run(worlds::with(world, age), {fast, fast, 1.0});
    const auto plain = worlds::run(world, {fast, fast, 1.0});
    // Distances from the plain world's own readings, so that only the age is looked at.
    const Experiment near = experiment_of(Kind::Proximity, {{"t_s", {0, 1}},
                                                            {"sensor", {0, 0}},
                                                            {"distance_m", {0.03, 0.04}},
                                                            {"reading", {300, 200}},
                                                            {"velocity", {-rate, -rate}}});
    const auto model = make_model(near);
    const Prediction now = predicted(*model), then = predicted(*model, age);
    for (std::size_t row = 0; row < 2; ++row) {
        std::size_t k = 100;
        while (k + 1 < plain.size() && plain[k][0] < now[0].mean[row])
            ++k;
        REQUIRE(k + 1 < plain.size());
        CHECK(aged[k][0] == Approx(then[0].mean[row]).epsilon(0.01));
    }
}

TEST_CASE("the ground row in the world tilts and warms up as in the forward model") {
    physics::World world = worlds::world_with_robot(3, 3);
    world.parameters = {{"ground.noise", 0}, {"ground.white", 700}};
    const Changes changes{
        {"ground.acceleration_tilt", 0.1}, {"ground.warmup_gain", 0.1}, {"ground.warmup_time", 25}};
    physics::WorldModel model(worlds::with(world, changes));
    worlds::Driver driver(model);
    Table rows;
    double speed = 0;
    for (int k = 0; k < 40; ++k) {
        driver.drive(k % 4 < 2 ? 500 : 0, k % 4 < 2 ? 500 : 0, 0.1);
        const auto& state = model.state(0);
        rows["t_s"].push_back(model.seconds());
        rows["sensor"].push_back(1);
        rows["grey"].push_back(1);
        rows["pitch_rad"].push_back(-state.pitch);
        rows["acceleration"].push_back((state.velocity[0] - speed) / 0.1);
        rows["reading"].push_back(model.robot(0).channels()[physics::kGroundChannel + 1]);
        speed = state.velocity[0];
    }
    const Experiment experiment =
        experiment_of(Kind::Ground, rows, {{"ground.white", 700}, {"ground.warmup_time", 25}});
    const Prediction said =
        predicted(*make_model(experiment), {{"ground.acceleration_tilt", 0.1}, {"ground.warmup_gain", 0.1}});
    double most = 0;
    for (std::size_t k = 0; k < 40; ++k) {
        const double signal = std::min(said[0].mean[k], 1.2 * 700);
        CHECK(rows["reading"][k] == Approx(signal).margin(0.2));
        most = std::max(most, std::abs(said[0].mean[k] - 700));
    }
    CHECK(most > 50);
}

TEST_CASE("the accelerometer in the world follows the forward model in every parameter") {
    physics::World world = worlds::world_with_robot(3, 3);
    world.parameters = {{"world.slope_x", 0.03}, {"world.slope_y", 0.02}};
    const worlds::Drive drive{300, 300, 2.0};
    physics::WorldModel still(world);
    worlds::Driver driver(still);
    driver.drive(300, 300, 2.0);
    const auto& state = still.state(0);
    Table row{{"t_s", {1, 2}}, {"motor_speed", {300, 300}}};
    row["pitch_rad"].assign(2, 0.03 - state.pitch);
    row["roll_rad"].assign(2, 0.02 - state.roll);
    for (const char* axis : {"ax", "ay", "az"})
        row[axis] = {2048, 2050};
    const Experiment experiment = experiment_of(Kind::Accelerometer, row);
    const auto model = make_model(experiment);
    const Prediction plain = predicted(*model);
    const auto unchanged = worlds::run(world, drive);
    for (const Changes& changes :
         {Changes{{"accelerometer.scale0", 1.1}, {"accelerometer.scale2", 0.95}},
          Changes{{"accelerometer.turn", 0.1}}, Changes{{"accelerometer.motor_sag", 0.013}},
          Changes{{"accelerometer.warmup", 40}, {"accelerometer.warmup_time", 20}}}) {
        const Prediction said = predicted(*model, changes);
        const auto changed = worlds::run(worlds::with(world, changes), drive);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            INFO(changes.begin()->first << ", axis " << axis);
            const std::size_t channel = physics::kAccelerationChannel + axis;
            CHECK(changed.back()[channel] - unchanged.back()[channel] ==
                  Approx(said[axis].mean[1] - plain[axis].mean[1]).margin(0.6));
        }
    }
    const Changes shaking{{"accelerometer.vibration", 60}};
    const auto noise =
        worlds::difference(worlds::run(worlds::with(world, shaking), {300, 300, 10}),
                           worlds::run(world, {300, 300, 10}), physics::kAccelerationChannel + 2, 500);
    CHECK(worlds::sd_of(noise) == Approx(predicted(*model, shaking)[2].extra[1]).epsilon(0.04));
}
