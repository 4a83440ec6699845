// What no replicate of the fitted model shows is left: errors that the noise's own carry-over can follow row
// by row, but never as far.

#include "base/random.h"
#include "gap/evidence/thresholds.h"
#include "gap/pipeline/analyse.h"
#include "tests/gap/simulated.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

/// Eight runs of a ground sensor over changing grey, errors carried over by 0.6; in run 5 a slow wave of so
/// many counts, of its own phase and speed.
Verdict with_wave(std::uint64_t seed, double counts, double ceiling = 1023) {
    RandomStream random(seed, "replicates test");
    Experiment experiment;
    experiment.kind = Kind::Ground;
    experiment.title = "toy";
    experiment.instruments["reading"] = {0, ceiling, 1};
    const double phase = 6.3 * random.uniform(), period = 60 + 90 * random.uniform();  // rows
    for (int r = 0; r < 8; ++r) {
        Run run;
        run.name = "run" + std::to_string(r);
        run.rows = 150;
        double error = 0.0;
        for (int k = 0; k < 150; ++k) {
            const double grey = 0.5 + 0.3 * std::sin(0.7 * k + r);
            error = 0.6 * error + 0.8 * 3 * random.normal();
            const double wave = r == 5 ? counts * std::sin(2 * std::numbers::pi * k / period + phase) : 0.0;
            run.columns["t_s"].push_back(0.1 * k);
            run.columns["grey"].push_back(grey);
            run.columns["reading"].push_back(500);
            run.columns["wrong"].push_back(error + wave);
        }
        experiment.runs.push_back(std::move(run));
    }
    test::fill(experiment, "reading", [&](double simulated, std::uint32_t run, std::uint32_t row) {
        return std::round(simulated + experiment.runs[run].columns["wrong"][row]);
    });
    for (Run& run : experiment.runs)
        run.columns.erase("wrong");
    Options options;
    options.seed = seed;
    return analyse(experiment, options);
}

}  // namespace

TEST_CASE("a run that strays farther than the fitted errors do is left") {
    for (const std::uint64_t seed : {1, 2, 3}) {
        const Verdict strays = with_wave(seed, 25);
        CHECK(strays.decision == Decision::Unexplained);
        CHECK(std::any_of(strays.leftovers.begin(), strays.leftovers.end(), [](const Leftover& one) {
            return one.covariate == "spread per run" && one.p_value < thresholds::kReported &&
                   one.shape.find("at run 6") != std::string::npos;
        }));
        CHECK(with_wave(seed, 0).decision == Decision::NoEffect);
    }
}

TEST_CASE("readings beyond a stated ceiling are as at it, measured and replicated") {
    // White reads some 830 here: the stated end is below.
    for (const std::uint64_t seed : {1, 2, 3}) {
        const Verdict verdict = with_wave(seed, 0, 780);
        CHECK(verdict.decision == Decision::NoEffect);
        CHECK(std::none_of(verdict.leftovers.begin(), verdict.leftovers.end(), [](const Leftover& one) {
            return one.shape.find("where the fit makes") != std::string::npos;
        }));
    }
}

TEST_CASE("what one run alone shows is no cause, but the run is asked for again") {
    RandomStream random(5, "replicates test/one run");
    Experiment experiment;
    experiment.kind = Kind::Ground;
    experiment.title = "toy";
    experiment.instruments["reading"] = {0, 1023, 1};
    for (int r = 0; r < 6; ++r) {
        Run run;
        run.name = "run" + std::to_string(r);
        run.rows = 120;
        for (int k = 0; k < 120; ++k) {
            run.columns["t_s"].push_back(0.1 * k);
            run.columns["sensor"].push_back(r == 0 ? k % 2 : 0);
            run.columns["grey"].push_back(0.5 + 0.3 * std::sin(0.7 * k + r));
            run.columns["reading"].push_back(500);
        }
        experiment.runs.push_back(std::move(run));
    }
    test::fill(experiment, "reading", [&](double simulated, std::uint32_t run, std::uint32_t row) {
        const double gain = experiment.runs[run].columns["sensor"][row] > 0 ? 1.08 : 1.0;
        return std::round(gain * simulated + 3 * random.normal());
    });
    const Verdict verdict = analyse(experiment, {});
    CHECK(verdict.decision == Decision::Unexplained);
    CHECK(std::any_of(verdict.cautions.begin(), verdict.cautions.end(), [](const std::string& caution) {
        return caution.find("ground_gain") != std::string::npos &&
               caution.find("record more of these") != std::string::npos;
    }));
}
