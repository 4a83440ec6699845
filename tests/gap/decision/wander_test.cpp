// Sums that wander beside what was measured: seen where they do, not where errors carry over, and no ground
// for pushes. And a measured heading, whose noise is in the residual, too.

#include "gap/decide/roles.h"
#include "gap/diagnostics/residual_structure.h"
#include "gap/fit_test/wander.h"
#include "tests/gap/decision/toy_drives.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <string_view>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

constexpr double kStep = 4e-4;  // m that a row goes astray, where it does
constexpr double kPush = 0.012, kPushed = 0.03;

/// Each row goes astray by `step` m, and one in so many is pushed.
Experiment drives(double step, std::uint64_t seed, double carry = 0.0, double pushes = 0.0) {
    return toy_drives(
        [&](RandomStream& random, int, int, double) {
            const double astray = step * random.normal();
            return Made{1.0, astray + (random.uniform() < pushes ? kPush : 0.0)};
        },
        seed, carry);
}

/// Why pushes, fitted to a drive, are none; empty: they may be.
std::string doubt_of_pushes(const Experiment& experiment) {
    const Study study(experiment, 1);
    const auto& all = study.candidates();
    const auto pushes = std::find_if(all.begin(), all.end(), [](const Candidate& one) {
        return one.effect->name == std::string_view("collision_push");
    });
    const Fit fit =
        study.fit_set({static_cast<std::size_t>(pushes - all.begin())}, study.fit_none().fitted.state);
    return out_of_role(study, fit, study.hold_out(fit), {}, 1).why;
}

std::vector<Leftover> seen(const Experiment& experiment, MotionView view) {
    const Study study(experiment, 1, 1, view);
    const Fit none = study.fit_none();
    return wandering(study, none, 0.01);
}

}  // namespace

TEST_CASE("a way that wanders is a structure, errors of the tracker are none", "[gap][wander]") {
    int alarms = 0;
    for (const std::uint64_t seed : {11U, 12U, 13U, 14U, 15U, 16U}) {
        alarms += seen(drives(0.0, seed, 0.8), MotionView::Room).empty() ? 0 : 1;
        const auto found = seen(drives(kStep, seed), MotionView::Room);
        REQUIRE_FALSE(found.empty());
        CHECK(found.front().p_value < 1e-4);
        CHECK_THAT(found.front().shape, Catch::Contains("wanders by"));
    }
    CHECK(alarms <= 1);  // of six at one in a hundred each: two come once in some 700 seeds
}

TEST_CASE("beside what wanders pushes are none", "[gap][wander]") {
    const bool wanders = GENERATE(true, false);
    const std::string doubt = doubt_of_pushes(drives(wanders ? kStep : 0.0, 21, 0.0, kPushed));
    CHECK((doubt.find("wander") != std::string::npos) == wanders);
}

TEST_CASE("sums along measured headings are looked at in the room", "[gap][wander]") {
    const bool wanders = GENERATE(true, false);
    const Experiment experiment = drives(wanders ? kStep : 0.0, 21);
    CHECK(seen(experiment, MotionView::Robot).empty());  // the heading keeps to its wheels
    const Study study(experiment, 1);
    const Fit none = study.fit_none();
    CHECK(wanders_anywhere(study, none, 1e-4) == wanders);
}

TEST_CASE("a heading at the edge of two sectors is in one of them", "[gap][wander]") {
    const double edge = GENERATE(as<double>{}, 15.0, 45.0, 180.0) * std::numbers::pi / 180;
    RandomStream random(31, "headings");
    Experiment experiment;
    experiment.kind = Kind::Motion;
    Series series;
    for (std::uint32_t r = 0; r < 2; ++r) {
        Run run;
        run.rows = 40;
        for (std::uint32_t i = 0; i < run.rows; ++i) {
            const double noise = 5e-3 * random.normal();
            run.columns["theta_rad"].push_back((r == 0 ? edge : std::numbers::pi / 2) + noise);
            series.run.push_back(r);
            series.row.push_back(i);
        }
        experiment.runs.push_back(std::move(run));
    }
    const auto covariates = covariates_of(experiment, series);
    REQUIRE(covariates.size() == 1);
    CHECK(covariates[0].name == "theta");
    const std::set<double> first(covariates[0].value.begin(), covariates[0].value.begin() + 40);
    CHECK(first.size() == 1);
}
