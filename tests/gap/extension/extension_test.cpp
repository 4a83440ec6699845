// The whole way: an effect outside the catalogue, the term that is learnt of it, its gain on other runs, and
// the overlay that a run takes.

#include "base/random.h"
#include "gap/overlay/overlay.h"
#include "gap/pipeline/analyse.h"
#include "physics/description/plan.h"
#include "scenarios/reader/read_scenario.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>

using namespace puckloop;
using namespace puckloop::gap;
using Catch::Matchers::Contains;

namespace {

/// A floor of greys under three sensors, eight runs; `more`: counts beyond the simulator's.
template <class More>
Experiment floors(const More& more, std::uint64_t seed) {
    RandomStream random(seed, "extended floors");
    Experiment experiment;
    experiment.kind = Kind::Ground;
    experiment.title = "greys";
    for (int r = 0; r < 8; ++r) {
        Run run;
        run.name = "run" + std::to_string(r);
        for (int i = 0; i < 240; ++i) {
            const int sensor = i % 3;
            const double grey = 0.1 * static_cast<double>(random.below(11)), time = 0.1 * i;
            run.columns["t_s"].push_back(time);
            run.columns["sensor"].push_back(sensor);
            run.columns["grey"].push_back(grey);
            run.columns["reading"].push_back(
                std::round(329 + 624 * grey + more(sensor, grey, time) + 3 * random.normal()));
            ++run.rows;
        }
        experiment.runs.push_back(std::move(run));
    }
    return experiment;
}

std::vector<physics::ExtensionTerm> loaded(const Experiment& experiment, const Verdict& verdict) {
    scenarios::Scenario scenario;
    scenario.world.arena = physics::rectangular_arena(1, 1);
    const auto file = tests::scratch_path("extension_test.toml");
    std::ofstream(file) << overlay_toml(experiment, verdict);
    scenarios::apply_overlay(scenario, file);
    std::filesystem::remove(file);
    return scenario.world.extension;
}

}  // namespace

TEST_CASE("an effect outside the catalogue extends the model", "[gap][extension]") {
    const auto more = [](int, double grey, double time) {
        return 40 * std::sin(8 * grey) * std::cos(time / 4) - 60;
    };
    const Experiment experiment = floors(more, 1);
    const Verdict verdict = analyse(experiment);
    INFO(verdict.summary << '\n' << verdict.extension.sentence);
    REQUIRE(verdict.extension.observables.size() == 1);
    const Extended& one = verdict.extension.observables.front();
    CHECK(one.quantity == "ground.reading");
    CHECK(one.kept);
    CHECK(one.named > 15.0);
    CHECK(one.extended < 6.0);  // the noise is 3
    CHECK(one.ratio < 0.4);
    CHECK(one.high < 0.6);
    CHECK(one.better == one.blocks);
    CHECK_THAT(verdict.extension.sentence, Contains("it is in the overlay"));
    const auto terms = loaded(experiment, verdict);
    REQUIRE_FALSE(terms.empty());
    CHECK(terms.front().adds_to == "ground.reading");
    CHECK(terms.front().sd.size() == terms.front().value.size());
    CHECK(to_json(verdict).find("\"extension\"") != std::string::npos);
}

TEST_CASE("where nothing is wrong nothing is asked, and nothing is written", "[gap][extension]") {
    const Experiment experiment = floors([](int, double, double) { return 0.0; }, 2);
    const Verdict verdict = analyse(experiment);
    CHECK(verdict.decision == Decision::NoEffect);
    CHECK_FALSE(verdict.extension.not_asked.empty());
    CHECK(loaded(experiment, verdict).empty());
}

TEST_CASE("what differs from run to run and from nothing else gains nothing", "[gap][extension]") {
    RandomStream random(5, "runs differ");
    std::vector<double> offsets;
    for (int r = 0; r < 8; ++r)
        offsets.push_back(40 * random.normal());
    int row = 0;
    const Experiment experiment =
        floors([&](int, double, double) { return offsets[static_cast<std::size_t>(row++ / 240)]; }, 3);
    const Verdict verdict = analyse(experiment);
    INFO(verdict.summary << '\n' << verdict.extension.sentence);
    for (const Extended& one : verdict.extension.observables)
        if (one.kept) CHECK(one.ratio > 0.8);
}
