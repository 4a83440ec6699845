// Noise finer than the step that values keep to: where readings fall between two steps shows in their means
// and sizes, and is no effect.

#include "base/random.h"
#include "gap/decide/roles.h"
#include "gap/pipeline/analyse.h"
#include "tests/gap/candidate.h"
#include "tests/gap/simulated.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <string>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

constexpr double kMillisecond = 1e-3;

/// Frames in whole milliseconds of the host's clock; each run begins between two of them, or all at one
/// place.
Experiment frames(std::uint64_t seed, double jitter, bool even) {
    RandomStream random(seed, "coarse steps/frames");
    double begun = 0.5073;
    return test::recorded(Kind::Timing, 6, 400, [&](Run& run, int, int k) {
        if (k == 0 && !even) begun = 0.5 + random.uniform();
        const double robot = 0.1 * k, host = robot + begun + jitter * random.normal();
        run.columns["seq"].push_back(k);
        run.columns["t_robot_s"].push_back(robot + (even ? 0.0 : 1e-5 * std::round(random.normal())));
        run.columns["t_host_s"].push_back(std::round(host / kMillisecond) * kMillisecond);
        run.columns["bytes"].push_back(84);
    });
}

/// Eight sensors before a wall, in whole counts; noise of so many, and of such a share of the reading.
Experiment wall(std::uint64_t seed, double noise, double share) {
    Experiment experiment;
    experiment.kind = Kind::Proximity;
    experiment.nominal["proximity.curve"] = 1;
    experiment.instruments["reading"] = {0, 4095, 1};
    RandomStream order(seed, "coarse steps/order");
    for (int r = 0; r < 8; ++r) {
        Run run;
        run.name = "run" + std::to_string(r);
        run.rows = 144;
        for (std::size_t k = 0; k < run.rows; ++k) {
            run.columns["t_s"].push_back(0.1 * static_cast<double>(k));
            run.columns["sensor"].push_back(std::floor(8 * order.uniform()));
            run.columns["distance_m"].push_back(0.005 * (1 + std::floor(12 * order.uniform())));
        }
        run.columns["reading"].assign(run.rows, 0.0);
        experiment.runs.push_back(std::move(run));
    }
    RandomStream random(seed, "coarse steps/readings");
    test::fill(experiment, "reading", [&](double level, std::uint32_t, std::uint32_t) {
        return std::round(level + std::hypot(noise, share * level) * random.normal());
    });
    return experiment;
}

}  // namespace

TEST_CASE("jitter below the step of the host's clock is no effect") {
    for (std::uint64_t seed = 1; seed <= 3; ++seed)
        for (const bool even : {true, false}) {
            INFO("seed " << seed << (even ? ", all begin alike" : ""));
            const Verdict verdict = analyse(frames(seed, 0.3 * kMillisecond, even));
            CHECK(verdict.decision == Decision::NoEffect);
        }
}

TEST_CASE("noise of a share of a count is no noise that grows with the reading") {
    const Experiment experiment = wall(1, 0.3, 0.0);
    CHECK(analyse(experiment).decision == Decision::NoEffect);
    // Were it taken, it would widen readings by less than their rounding.
    const Study study(experiment, 1);
    const std::size_t grows = candidate(study, "proportional_noise");
    Fit fit = study.fit_set({grows}, study.fit_none().fitted.state);
    double& share = fit.fitted.state.values[fit.freed.front().index];
    share = 2e-4;
    CHECK(within_rounding(study, fit, grows));
    share = 0.01;
    CHECK_FALSE(within_rounding(study, fit, grows));
}

TEST_CASE("noise that grows beyond the step is named, however fine the rest") {
    const Verdict verdict = analyse(wall(1, 0.3, 0.01));
    CHECK(verdict.decision == Decision::Named);
    REQUIRE(verdict.causes.size() == 1);
    CHECK(verdict.causes.front().name == "proportional_noise");
}
