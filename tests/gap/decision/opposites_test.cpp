// Effects that hide each other: each alone says next to nothing, both together all.

#include "base/random.h"
#include "gap/pipeline/analyse.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

constexpr int kRuns = 8, kRows = 60;
constexpr double kSide = 0.06, kLost = 0.35;  // what is heard more in front; samples left out

/// A robot turning before a loudspeaker, near and far, with two lengths of window. Formulas of its own.
Experiment turns() {
    RandomStream random(5, "test/opposites");
    Experiment experiment;
    experiment.kind = Kind::Microphone;
    experiment.title = "opposites";
    experiment.instruments["level"] = {0, 4095, 1};
    for (int r = 0; r < kRuns; ++r) {
        Run run;
        run.name = "run" + std::to_string(r);
        run.rows = kRows;
        const double distance = 0.1 + 0.05 * (r % 4), samples = r < kRuns / 2 ? 100 : 50;
        for (int k = 0; k < kRows; ++k) {
            const double angle = std::numbers::pi * (-0.5 + 1.0 * k / kRows);
            const double share = std::sqrt(std::log(samples * (1 - kLost)) / std::log(samples));
            const double level = 400 * 0.1 / distance * (1 + kSide * std::cos(angle)) * share;
            run.columns["t_s"].push_back(0.1 * k);
            run.columns["mic"].push_back(0);
            run.columns["distance_m"].push_back(distance);
            run.columns["angle_rad"].push_back(angle);
            run.columns["amplitude"].push_back(400);
            run.columns["window"].push_back(samples);
            run.columns["level"].push_back(std::round(level + 1.5 * random.normal()));
        }
        experiment.runs.push_back(std::move(run));
    }
    return experiment;
}

}  // namespace

TEST_CASE("two effects that pull opposite ways are found together", "[gap][decision]") {
    const Verdict verdict = analyse(turns(), {});
    REQUIRE(verdict.decision == Decision::Named);
    REQUIRE(verdict.causes.size() == 2);
    for (const Cause& cause : verdict.causes) {
        INFO(cause.name);
        REQUIRE_FALSE(cause.parameters.empty());
        const FittedParameter& found = cause.parameters.front();
        REQUIRE((cause.name == "microphone_directivity" || cause.name == "microphone_window"));
        const double hidden = cause.name == "microphone_window" ? kLost : kSide;
        CHECK(found.low < 1.02 * hidden);
        CHECK(found.high > 0.98 * hidden);
        CHECK(cause.evidence > 8);
    }
}
