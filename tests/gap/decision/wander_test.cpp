// Sums that wander beside what was measured: seen where they do, not where errors carry over, and no ground
// for pushes.

#include "gap/diagnostics/residual_structure.h"
#include "gap/fit_test/wander.h"
#include "tests/gap/decision/toy_drives.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <set>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

constexpr double kStep = 4e-4;  // m that a row goes astray, where it does

Experiment drives(double step, std::uint64_t seed) {
    return toy_drives(
        [&](RandomStream& random, int, int, double) {
            return Made{1.0, step * random.normal()};
        },
        seed);
}

std::vector<Leftover> seen(const Experiment& experiment, MotionView view) {
    const Study study(experiment, 1, 1, view);
    const Fit none = study.fit_none();
    return wandering(study, none, study.hold_out(none), 0.01);
}

}  // namespace

TEST_CASE("a way that wanders is a structure, errors of the tracker are none", "[gap][wander]") {
    int alarms = 0;
    for (const std::uint64_t seed : {11U, 12U, 13U, 14U, 15U, 16U}) {
        alarms += seen(drives(0.0, seed), MotionView::Room).empty() ? 0 : 1;
        const auto found = seen(drives(kStep, seed), MotionView::Room);
        REQUIRE_FALSE(found.empty());
        CHECK(found.front().p_value < 1e-4);
        CHECK_THAT(found.front().shape, Catch::Contains("wanders by"));
    }
    CHECK(alarms <= 1);
}

TEST_CASE("sums along measured headings are looked at in the room", "[gap][wander]") {
    const bool wanders = GENERATE(true, false);
    const Experiment experiment = drives(wanders ? kStep : 0.0, 21);
    CHECK(seen(experiment, MotionView::Robot).empty());  // the heading keeps to its wheels
    const Study study(experiment, 1);
    const Fit none = study.fit_none();
    CHECK(wanders_anywhere(study, none, study.hold_out(none), 1e-4) == wanders);
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
            run.columns["theta_rad"].push_back((r == 0 ? edge : 0.0) + noise);
            series.run.push_back(r);
            series.row.push_back(i);
        }
        experiment.runs.push_back(std::move(run));
    }
    for (const auto& covariate : covariates_of(experiment, series)) {
        CHECK(covariate.name == "theta");
        const std::set<double> first(covariate.value.begin(), covariate.value.begin() + 40);
        CHECK(first.size() == 1);
    }
}
