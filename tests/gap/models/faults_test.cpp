// Faults that a second generator of cases has shown, each held here: a sign, a track that stands still, runs
// of different rates, clocks that are rounded, a latency that a run has by itself.

#include "base/random.h"
#include "gap/clean/quantum.h"
#include "gap/effects/effect.h"
#include "gap/overlay/overlay_parts.h"
#include "gap/residuals/residual_structure.h"
#include "physics/sensors/accelerometer.h"
#include "tests/gap/models/made_table.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace puckloop;
using namespace puckloop::gap;
using puckloop::gap::tests::experiment_of;
using puckloop::gap::tests::predicted;
using puckloop::gap::tests::Table;

TEST_CASE("a rolled body feels its lateral acceleration as the simulated sensor does") {
    RandomStream random(1, "faults/roll");
    for (int k = 0; k < 20; ++k) {
        const double roll = 0.06 * (2 * random.uniform() - 1), pitch = 0.06 * (2 * random.uniform() - 1),
                     left = 6 * random.uniform() - 3, forward = 6 * random.uniform() - 3;
        physics::AccelerometerParameters parameters = physics::Parameters().accelerometer;
        parameters.bandwidth = 1e6;  // Hz: the low pass is none
        physics::Accelerometer sensor(parameters, physics::Parameters().world, 1, "robot");
        physics::RobotState robot;
        robot.roll = roll;
        robot.pitch = -pitch;  // nose down is positive there
        (void)sensor.sense(robot, {});
        robot.velocity = {forward * physics::kStepSeconds, left * physics::kStepSeconds, 0.0};
        const auto counts = sensor.sense(robot, {});
        const Experiment experiment =
            experiment_of(Kind::Accelerometer, {{"t_s", {0, 1}},
                                                {"ax", {2048, 2050}},
                                                {"ay", {2048, 2050}},
                                                {"az", {2848, 2850}},
                                                {"pitch_rad", {pitch, pitch}},
                                                {"roll_rad", {roll, roll}},
                                                {"acceleration", {forward, forward}},
                                                {"lateral", {left, left}}});
        const auto said = predicted(*make_model(experiment));
        for (std::size_t axis = 0; axis < 3; ++axis) {
            INFO("axis " << axis << " roll " << roll << " left " << left);
            // Tilts are small there and exact here: second order apart.
            CHECK(said[axis].mean[0] == Approx(counts[axis]).margin(4.0));
        }
    }
}

TEST_CASE("a floor sensor carried from patch to patch sees each patch, not the last one") {
    const std::vector<double> grey{0.1, 0.9, 0.4, 0.7, 0.2}, rate{0, 20, -20, 0, 10};
    Table table{{"t_s", {0, 1, 2, 3, 4}}, {"grey", grey}, {"grey_rate", rate}, {"reading", {1, 2, 3, 4, 5}}};
    const Experiment experiment = experiment_of(Kind::Ground, table);
    const auto model = make_model(experiment);
    const auto neutral = predicted(*model)[0].mean;
    for (const double ahead : {0.002, -0.002}) {
        const auto moved = predicted(*model, {{"ground.forward_error", ahead}})[0].mean;
        for (std::size_t i = 0; i < grey.size(); ++i) {
            INFO("patch " << i << " ahead " << ahead);
            CHECK(moved[i] - neutral[i] == Approx((953 - 329) * rate[i] * ahead).margin(1.0));
        }
    }
}

TEST_CASE("a run of a slower rate is not cut at every row") {
    Experiment experiment;
    experiment.kind = Kind::Ground;
    for (const double step : {0.01, 0.01, 0.2}) {
        Run run;
        run.rows = 50;
        for (int k = 0; k < 50; ++k) {
            // A gap in the middle of each.
            run.columns["t_s"].push_back(step * (k < 25 ? k : k + 20));
            run.columns["grey"].push_back(0.5);
            run.columns["reading"].push_back(500 + k % 3);
        }
        experiment.runs.push_back(run);
    }
    const auto model = make_model(experiment);
    const Observable& o = model->observables()[0];
    std::vector<int> begins(3, 0);
    for (std::size_t i = 0; i < o.y.size(); ++i)
        begins[o.run[i]] += o.starts[i];
    CHECK(begins == std::vector<int>{2, 2, 2});
}

TEST_CASE("the step that values are rounded to is seen in them") {
    RandomStream random(2, "faults/quantum");
    for (const double step : {1.0, 1e-3, 0.5 * std::numbers::pi / 180, 0.25, 1e-5}) {
        std::vector<double> values;
        const double centre = 40 * random.uniform();
        for (int k = 0; k < 500; ++k)
            values.push_back(step * std::round(centre / step + 30 * random.normal()));
        INFO("step " << step);
        CHECK(quantum_of(values) == Approx(step).epsilon(1e-6));
    }
    std::vector<double> fine, hardly{1.0, 1.5, 1.0};
    for (int k = 0; k < 500; ++k)
        fine.push_back(random.normal());
    CHECK(quantum_of(fine) == 0.0);
    CHECK(quantum_of(hardly) == 0.0);
}

TEST_CASE("rounded clocks and trackers enter the likelihood") {
    RandomStream random(3, "faults/rounded");
    Table drive, frames;
    for (int k = 0; k < 100; ++k) {
        drive["t_s"].push_back(0.1 * k);
        drive["x_m"].push_back(1e-3 * std::round(4.3 * k));
        drive["y_m"].push_back(1e-3 * std::round(2 * random.normal()));
        drive["theta_rad"].push_back(std::numbers::pi / 360 * std::round(3 * random.normal()));
        drive["cmd_left"].push_back(300);
        drive["cmd_right"].push_back(300);
        frames["t_robot_s"].push_back(1e-3 * std::round(104.3 * k));
        frames["t_host_s"].push_back(1e-3 * std::round(104.3 * k + 13 + 3 * random.uniform()));
    }
    const auto motion = make_model(experiment_of(Kind::Motion, drive));
    CHECK(motion->observables()[0].instrument.quantum == Approx(1e-3));
    CHECK(motion->observables()[2].instrument.quantum == Approx(std::numbers::pi / 360));
    const auto timing = make_model(experiment_of(Kind::Timing, frames));
    CHECK(timing->observables()[0].instrument.quantum == Approx(1e-3));
    CHECK(timing->observables()[1].instrument.quantum == Approx(1e-3 * std::sqrt(2.0)));
}

TEST_CASE("no latency and no tracker is early") {
    int found = 0;
    for (const Effect& effect : catalogue()) {
        const std::string_view name = effect.name;
        if (name != "command_latency" && name != "tracker_delay") continue;
        ++found;
        CHECK(effect.parameters.front().low >= 0.0);
    }
    CHECK(found == 2);
}

TEST_CASE("the latency that a run has by itself is not in the overlay again") {
    std::map<std::string, double> fitted{{"command.latency", 0.0433}};
    CHECK(links_overlay({}, fitted).find("command_delay = \"0.04 s\"") != std::string::npos);
    fitted = {{"command.latency", 0.0433}};
    CHECK(links_overlay({{"command.latency", 0.0133}}, fitted).find("command_delay = \"0.03 s\"") !=
          std::string::npos);
}

TEST_CASE("the measured heading is asked about by sectors only") {
    RandomStream random(4, "faults/heading");
    Table drive;
    for (int k = 0; k < 200; ++k) {
        drive["t_s"].push_back(0.1 * k);
        for (const char* name : {"x_m", "y_m"})
            drive[name].push_back(1e-3 * random.normal());
        drive["theta_rad"].push_back(0.02 * k + 0.01 * random.normal());
    }
    const Experiment experiment = experiment_of(Kind::Motion, drive);
    Series series;
    for (std::uint32_t k = 0; k < 200; ++k)
        series.run.push_back(0), series.row.push_back(k), series.measured.push_back(0.0);
    for (const auto& covariate : covariates_of(experiment, series)) {
        if (covariate.name != "theta") continue;
        for (const double value : covariate.value)
            CHECK(std::abs(std::remainder(value, std::numbers::pi / 6)) < 1e-9);
    }
}
