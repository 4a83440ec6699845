// Robots that keep to their commands and robots that make a staircase of them are told apart, whatever their
// wheels.

#include "base/random.h"
#include "gap/diagnostics/agenda.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace puckloop;
using namespace puckloop::gap;
using Catch::Matchers::Contains;

namespace {

struct Robot {
    bool staircase = true;
    double wheel = 1.0, axle = 1.0;  ///< times what is taken for granted
};

/// Six drives with new commands every second; the tracker errs by 1 mm and 5 mrad.
Experiment drives(const Robot& robot) {
    constexpr double kMetre = 2 * std::numbers::pi * 0.0205 / 1000, kAxle = 0.053, kRow = 0.1;
    Experiment experiment;
    experiment.kind = Kind::Motion;
    experiment.folder = "made";
    for (int r = 0; r < 6; ++r) {
        RandomStream random(5, "agenda test " + std::to_string(r));
        Run run;
        run.name = run.file = "run" + std::to_string(r);
        double x = 0.0, y = 0.0, heading = 0.0, left = 0.0, right = 0.0;
        for (int k = 0; k < 120; ++k) {
            if (k % 10 == 0) {
                left = std::round(300 + 500 * random.uniform());
                right = std::round(300 + 500 * random.uniform());
            }
            run.columns["t_s"].push_back(kRow * k);
            run.columns["x_m"].push_back(x + 1e-3 * random.normal());
            run.columns["y_m"].push_back(y + 1e-3 * random.normal());
            run.columns["theta_rad"].push_back(
                std::remainder(heading + 5e-3 * random.normal(), 2 * std::numbers::pi));
            run.columns["cmd_left"].push_back(left);
            run.columns["cmd_right"].push_back(right);
            ++run.rows;
            // The agenda moves a motor every so many tenths of a millisecond.
            const auto speed = [&](double command) {
                return robot.staircase ? 1e4 / std::floor(1e4 / command) : command;
            };
            const double l = speed(left) * kMetre * robot.wheel * kRow,
                         w = speed(right) * kMetre * robot.wheel * kRow;
            const double turn = (w - l) / (kAxle * robot.axle);
            x += (l + w) / 2 * std::cos(heading + turn / 2);
            y += (l + w) / 2 * std::sin(heading + turn / 2);
            heading += turn;
        }
        experiment.runs.push_back(std::move(run));
    }
    return experiment;
}

}  // namespace

TEST_CASE("a robot that keeps to its commands is not one of the original firmware's") {
    CHECK_THAT(agenda_caution(drives({false, 1.0, 1.0}), {}, 1, 2), Contains("\"firmware.agenda\" = 0"));
    CHECK_THAT(agenda_caution(drives({false, 1.04, 0.98}), {}, 1, 2), Contains("\"firmware.agenda\" = 0"));
}

TEST_CASE("and the other way round") {
    Experiment experiment = drives({true, 1.0, 1.0});
    experiment.nominal["firmware.agenda"] = 0;
    CHECK_THAT(agenda_caution(experiment, {}, 1, 2), Contains("\"firmware.agenda\" = 1"));
}

TEST_CASE("other wheels are no other motor driver") {
    CHECK(agenda_caution(drives({true, 0.96, 1.0}), {}, 1, 2).empty());
    CHECK(agenda_caution(drives({true, 1.0, 1.03}), {}, 1, 2).empty());
    Experiment kept = drives({false, 0.97, 1.0});
    kept.nominal["firmware.agenda"] = 0;
    CHECK(agenda_caution(kept, {}, 1, 2).empty());
}

TEST_CASE("where wheels are counted, commands do not matter") {
    Experiment counted = drives({false, 1.0, 1.0});
    for (Run& run : counted.runs)
        run.columns["steps_left"] = run.columns["steps_right"] = run.columns["t_s"];
    CHECK(agenda_caution(counted, {}, 1, 2).empty());
}
