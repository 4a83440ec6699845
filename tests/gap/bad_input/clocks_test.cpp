// Clocks of tracker and counters that run apart are found and put right; robots that are merely wrong are not
// taken for it.

#include "gap/clocks.h"

#include <catch2/catch.hpp>

#include "base/random.h"

#include <cmath>
#include <numbers>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

/// A drive of speeds that change smoothly; the tracker's rows come late(t) after the counters'.
Run drive(const std::string& name, double late, double drift, double axle_error) {
    constexpr double kMetre = 1e-4, kAxle = 0.2, kStep = 0.1, kLasts = 60.0, kFine = 0.01;
    RandomStream random(1, "clocks test " + name);
    const double phase = 6 * random.uniform();
    const auto speeds = [phase](double t) {
        const double v = 0.1 + 0.05 * std::sin(0.5 * t + phase), w = 0.6 * std::sin(0.8 * t + 2 * phase);
        return std::pair{v - w * kAxle / 2, v + w * kAxle / 2};
    };
    std::vector<double> left{0}, right{0}, x{0}, y{0}, theta{0};
    for (double t = 0; t < kLasts + 3; t += kFine) {
        const auto [l, r] = speeds(t);
        left.push_back(left.back() + l * kFine / kMetre);
        right.push_back(right.back() + r * kFine / kMetre);
        const double turn = (r - l) * kFine / (kAxle * (1 + axle_error));
        x.push_back(x.back() + (l + r) / 2 * kFine * std::cos(theta.back()));
        y.push_back(y.back() + (l + r) / 2 * kFine * std::sin(theta.back()));
        theta.push_back(theta.back() + turn);
    }
    Run run;
    run.name = run.file = name;
    for (double t = 1; t < kLasts; t += kStep) {
        const auto counted = static_cast<std::size_t>(std::lround(t / kFine));
        // The pose in this row belongs to the counters' clock at t - late.
        const double own = t - late - drift * ((t - 1) / (kLasts - 1) - 0.5);
        const auto seen = static_cast<std::size_t>(std::lround(own / kFine));
        run.columns["t_s"].push_back(t);
        run.columns["steps_left"].push_back(std::round(left[counted]));
        run.columns["steps_right"].push_back(std::round(right[counted]));
        run.columns["x_m"].push_back(x[seen] + 5e-4 * random.normal());
        run.columns["y_m"].push_back(y[seen] + 5e-4 * random.normal());
        run.columns["theta_rad"].push_back(theta[seen] + 2e-3 * random.normal());
        ++run.rows;
    }
    return run;
}

Experiment of(std::vector<Run> runs) {
    Experiment experiment;
    experiment.kind = Kind::Motion;
    experiment.runs = std::move(runs);
    return experiment;
}

}  // namespace

TEST_CASE("lateness and its drift are found, each run its own") {
    Experiment e =
        of({drive("a", 0.05, 0.3, 0.01), drive("b", -0.1, 0.2, 0.01), drive("c", 0.3, -0.2, 0.01)});
    const auto clocks = clock_errors(e);
    REQUIRE(clocks.size() == 3);
    const double late[] = {0.05, -0.1, 0.3}, drift[] = {0.3, 0.2, -0.2};
    for (std::size_t r = 0; r < 3; ++r) {
        CHECK(clocks[r].late == Approx(late[r]).margin(0.01));
        CHECK(clocks[r].drift == Approx(drift[r]).margin(0.03));
    }
    align_clocks(e);
    REQUIRE(e.cautions.size() == 1);
    CHECK(e.cautions.front().find("run apart") != std::string::npos);
    const Run& run = e.runs[0];
    REQUIRE(run.counted_at.size() == run.rows);
    // Over the run the correction grows by the drift.
    const double grown = (run.column("t_s").back() - run.counted_at.back()) -
                         (run.column("t_s").front() - run.counted_at.front());
    CHECK(grown == Approx(0.3).margin(0.03));
    // Of lateness that differs from run to run nothing is left to a tracker that is late.
    const double late_in_the_middle = run.column("t_s")[run.rows / 2] - run.counted_at[run.rows / 2];
    CHECK(late_in_the_middle == Approx(0.05).margin(0.02));
}

TEST_CASE("a lateness that runs with drifting clocks have in common is left to the tracker's delay") {
    Experiment e =
        of({drive("a", 0.2, 0.3, 0.01), drive("b", 0.21, 0.2, 0.01), drive("c", 0.19, -0.2, 0.01)});
    align_clocks(e);
    REQUIRE(e.cautions.size() == 1);
    const Run& run = e.runs[0];
    REQUIRE(run.counted_at.size() == run.rows);
    const double late_in_the_middle = run.column("t_s")[run.rows / 2] - run.counted_at[run.rows / 2];
    CHECK(late_in_the_middle == Approx(0.0).margin(0.02));
}

TEST_CASE("a robot of other numbers and a tracker that is always late are no clocks that run apart") {
    Experiment e = of({drive("a", 0.1, 0.0, 0.03), drive("b", 0.1, 0.0, 0.03), drive("c", 0.1, 0.0, 0.03)});
    align_clocks(e);
    CHECK(e.cautions.empty());
    CHECK(e.runs[0].counted_at.empty());
}
