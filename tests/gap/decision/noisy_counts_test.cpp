// Counters that err in each row: a number by which counts are multiplied is drawn to nothing by their errors,
// and must not be named.

#include "base/random.h"
#include "gap/identify/drive_filter.h"
#include "gap/pipeline/analyse.h"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

using namespace puckloop;
using namespace puckloop::gap;
using Catch::Matchers::Contains;

namespace {

constexpr double kCount = 1e-5, kRadius = 0.022;     // m
constexpr double kRow = 1.0 / 3, kAhead = 3.5e-3;    // s, m
constexpr int kRuns = 6, kRows = 450, kSmooth = 21;  // rows over which a turn is smoothed
constexpr double kTurns = 2e-3;                      // rad a row
constexpr double kSeen = 3e-4, kSeenHeading = 3e-3;  // m, rad

/// What a drive is: nearly straight, but for the turns that it makes besides, rad in a row.
struct Robot {
    double axle = 0.095, stated = 0.095;  // m
    double counts = 2e-4;                 // m a row, each wheel
    double besides = 0.0;                 // rad a row, for 50 rows each way
    double slips = 0.0;                   // rad a row that no wheel makes
};

Experiment drives(const Robot& robot, std::uint64_t seed) {
    RandomStream random(seed, "noisy counts");
    Experiment experiment;
    experiment.kind = Kind::Motion;
    experiment.title = "straight on";
    experiment.nominal = {{"robot.wheel_radius_left", kRadius},
                          {"robot.wheel_radius_right", kRadius},
                          {"robot.axle_length", robot.stated},
                          {"inverse_friction", 0.0},
                          {"robot.steps_per_turn", 2 * std::numbers::pi * kRadius / kCount}};
    for (int r = 0; r < kRuns; ++r) {
        std::array<double, kRows + kSmooth> turns{};
        for (double& one : turns)
            one = kTurns * random.normal();
        Run run;
        run.name = "run" + std::to_string(r);
        double x = 0, y = 0, heading = 0;
        std::array<double, 2> counted{};
        for (int i = 0; i < kRows; ++i) {
            if (i > 0) {
                double turn = robot.besides * (i / 50 % 2 == 0 ? 1 : -1);
                for (int k = 0; k < kSmooth; ++k)
                    turn += turns[static_cast<std::size_t>(i + k)] / kSmooth;
                x += kAhead * std::cos(heading + turn / 2);
                y += kAhead * std::sin(heading + turn / 2);
                heading += turn + robot.slips * random.normal();
                counted[0] += kAhead - turn * robot.axle / 2 + robot.counts * random.normal();
                counted[1] += kAhead + turn * robot.axle / 2 + robot.counts * random.normal();
            }
            run.columns["t_s"].push_back(kRow * i);
            run.columns["x_m"].push_back(x + kSeen * random.normal());
            run.columns["y_m"].push_back(y + kSeen * random.normal());
            run.columns["theta_rad"].push_back(heading + kSeenHeading * random.normal());
            run.columns["steps_left"].push_back(std::round(counted[0] / kCount));
            run.columns["steps_right"].push_back(std::round(counted[1] / kCount));
            ++run.rows;
        }
        experiment.runs.push_back(std::move(run));
    }
    return experiment;
}

Options two_threads() {
    Options options;
    options.threads = 2;
    return options;
}

/// The drive filter's rows of a made drive: `named` is the axle that a fit would name.
CountedDrive rows_of(const Experiment& experiment, double stated, double named) {
    CountedDrive drive;
    drive.quantum = kCount;
    drive.way.errors = 0.5;
    drive.turn.errors = 2.0;
    for (const Run& run : experiment.runs) {
        const auto &left = run.column("steps_left"), &right = run.column("steps_right"),
                   &theta = run.column("theta_rad"), &x = run.column("x_m"), &y = run.column("y_m");
        double along = 0.0;
        for (std::size_t i = 0; i < run.rows; ++i) {
            const bool begins = i == 0;
            const double l = begins ? 0.0 : (left[i] - left[i - 1]) * kCount,
                         r = begins ? 0.0 : (right[i] - right[i - 1]) * kCount;
            along += begins ? 0.0
                            : (x[i] - x[i - 1]) * std::cos(theta[i]) + (y[i] - y[i - 1]) * std::sin(theta[i]);
            drive.starts.push_back(begins ? 1 : 0);
            drive.spans.push_back(begins ? 0.0 : kRow);
            const auto add = [](DriveChannel& channel, double counted, double seen, double without,
                                double with) {
                channel.counted.push_back(counted);
                channel.seen.push_back(seen);
                channel.without.push_back(without * counted);
                channel.with.push_back(with * counted);
                channel.gain_without.push_back(without);
                channel.gain_with.push_back(with);
            };
            add(drive.way, (l + r) / 2, along, 1.0, 1.0);
            add(drive.turn, r - l, theta[i], 1 / stated, 1 / named);
        }
    }
    return drive;
}

}  // namespace

TEST_CASE("a drive's filter parts errors of counters from slip, and finds the axle beside them",
          "[gap][decision]") {
    Robot robot;
    const CountedDrive noisy = rows_of(drives(robot, 3), 0.095, 0.929);
    const DriveFit both = fit_drive(noisy, {});
    // The law's width is that of a Student's t: a normal error of 0.2 mm has 0.19.
    CHECK(both.counter_sd == Approx(2e-4).epsilon(0.1));
    CHECK(both.share < 0.5);
    CHECK(fit_drive(noisy, {.counters = false, .slip = true}).cost > both.cost + 100);
    // Without counter noise the name looks right.
    CHECK(fit_drive(noisy, {.counters = false, .slip = true}).share == Approx(1.0).margin(0.2));
    robot.counts = 0.0;
    robot.slips = 3e-3;
    const CountedDrive slipping = rows_of(drives(robot, 3), 0.095, 0.929);
    const DriveFit slip = fit_drive(slipping, {});
    CHECK(slip.slip_turn == Approx(3e-3).epsilon(0.15));
    CHECK(slip.counter_sd < 2e-5);
    CHECK(std::abs(slip.share) < 3 * slip.share_sd);
    CHECK(fit_drive(slipping, {.counters = true, .slip = false}).cost > slip.cost + 100);
    // A true axle of 98 mm, stated as 95, that the drives show.
    robot = {.axle = 0.098, .counts = 2e-4, .besides = 0.05};
    const DriveFit turning = fit_drive(rows_of(drives(robot, 3), 0.095, 0.098), {});
    CHECK(turning.share == Approx(1.0).margin(3 * turning.share_sd));
    CHECK(turning.share_sd < 0.1);
}

TEST_CASE("counters that err by 0.2 mm a row on nearly straight drives name no axle", "[gap][decision]") {
    const Verdict verdict = analyse(drives({}, 1), two_threads());
    INFO(verdict.summary);
    CHECK(verdict.causes.empty());
    CHECK(verdict.decision == Decision::NotIdentifiable);
    CHECK_THAT(verdict.summary, Contains("not identifiable by these drives"));
    CHECK_FALSE(verdict.suggestions.empty());
}

TEST_CASE("nor do they of a robot of an e-puck's axle", "[gap][decision]") {
    Robot robot;
    robot.axle = robot.stated = 0.053;
    const Verdict verdict = analyse(drives(robot, 1), two_threads());
    INFO(verdict.summary);
    CHECK(verdict.causes.empty());
    CHECK((verdict.decision == Decision::NotIdentifiable || verdict.decision == Decision::Unexplained));
}

TEST_CASE("an axle that the drives do show is named where the counters are exact", "[gap][decision]") {
    Robot robot;
    robot.axle = 0.098;
    robot.besides = 0.05;
    robot.counts = 0.0;
    const Verdict verdict = analyse(drives(robot, 2), two_threads());
    INFO(verdict.summary);
    REQUIRE(verdict.decision == Decision::Named);
    REQUIRE(verdict.causes.front().name == "axle_length");
    CHECK(verdict.causes.front().parameters.front().value == Approx(0.098).margin(1e-5));
}
