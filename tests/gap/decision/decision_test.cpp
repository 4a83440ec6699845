// The word of the verdict on toy experiments with ground sensors: nothing wrong, a cause of the catalogue,
// something alien, a cause that could take half of something alien, and single readings that go astray.

#include "base/random.h"
#include "gap/pipeline/analyse.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

constexpr int kRuns = 6, kRows = 120;
constexpr double kNoise = 3.0, kPeriod = 0.1, kWaveLength = 0.08, kSpeed = 0.05;

struct Place {
    int run, row, sensor;
    double grey;
};

Experiment made(std::uint64_t seed, const std::function<double(double level, const Place&)>& wrong) {
    RandomStream random(seed, "decision test");
    Experiment experiment;
    experiment.kind = Kind::Ground;
    experiment.title = "toy floor";
    experiment.instruments["reading"] = {0, 967, 1};
    for (int r = 0; r < kRuns; ++r) {
        Run run;
        run.name = "run" + std::to_string(r);
        run.rows = kRows;
        const double begin = random.uniform() * kWaveLength;
        for (int k = 0; k < kRows; ++k) {
            const int sensor = k / (kRows / 3);
            const double angle =
                2 * std::numbers::pi * (begin + kSpeed * kPeriod * (k % (kRows / 3))) / kWaveLength;
            const double grey = 0.5 + 0.4 * std::sin(angle);
            const double level = wrong(329 + (953 - 329) * grey, {r, k, sensor, grey});
            run.columns["t_s"].push_back(k * kPeriod);
            run.columns["sensor"].push_back(sensor);
            run.columns["grey"].push_back(grey);
            run.columns["grey_rate"].push_back(0.4 * 2 * std::numbers::pi / kWaveLength * std::cos(angle));
            run.columns["speed"].push_back(kSpeed);
            run.columns["reading"].push_back(
                std::clamp(std::round(level + kNoise * random.normal()), 0.0, 967.0));
        }
        experiment.runs.push_back(std::move(run));
    }
    return experiment;
}

Verdict verdict_on(const Experiment& experiment) {
    Options options;
    return analyse(experiment, options);
}

bool any_clear(const Verdict& verdict) {
    return std::any_of(verdict.free_forms.begin(), verdict.free_forms.end(),
                       [](const FreeForm& form) { return form.clear; });
}

}  // namespace

TEST_CASE("where nothing is wrong nothing is left") {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const Verdict verdict = verdict_on(made(seed, [](double level, const Place&) { return level; }));
        CHECK(verdict.decision == Decision::NoEffect);
        CHECK_FALSE(any_clear(verdict));
        CHECK(verdict.nearest.empty());
    }
}

TEST_CASE("a cause of the catalogue leaves nothing and is named") {
    const double gain[] = {0.97, 1.0, 0.95};
    const Verdict verdict =
        verdict_on(made(4, [&](double level, const Place& at) { return gain[at.sensor] * level; }));
    CHECK(verdict.decision == Decision::Named);
    REQUIRE(verdict.causes.size() == 1);
    CHECK(verdict.causes.front().name == "ground_gain");
    CHECK(verdict.unexplained_share < 0.1);
    CHECK(verdict.nearest.empty());
}

TEST_CASE("what the catalogue does not know is reported with its shape and without a name") {
    const Verdict verdict = verdict_on(made(5, [](double level, const Place& at) {
        return level + 2 * kNoise * std::sin(8 * std::numbers::pi * at.grey);
    }));
    CHECK(verdict.decision == Decision::Unexplained);
    CHECK(verdict.causes.empty());
    REQUIRE(any_clear(verdict));
    CHECK(verdict.free_forms.front().terms.front().over.find("grey") != std::string::npos);
    CHECK_FALSE(verdict.free_forms.front().shape.empty());
    CHECK(verdict.summary.find("grey") != std::string::npos);
}

TEST_CASE("a cause that takes half of something alien is nearest, not named") {
    // Middle greys read low, black and white as they should: gain and offset take a part of it.
    const Verdict verdict = verdict_on(made(6, [](double level, const Place& at) {
        return at.grey > 0.55 && at.grey < 0.85 ? level - 4 * kNoise : level;
    }));
    INFO("share left " << verdict.unexplained_share);
    CHECK(verdict.decision == Decision::Unexplained);
    CHECK(verdict.causes.empty());
    CHECK(verdict.rivals.empty());
    REQUIRE_FALSE(verdict.nearest.empty());
    CHECK(any_clear(verdict));
    const std::string json = to_json(verdict);
    CHECK(json.find("\"nearest\"") != std::string::npos);
    CHECK(json.find("unexplained: a correction without a mechanism") != std::string::npos);
}

TEST_CASE("a small alien structure does not hide a cause") {
    const double gain[] = {0.93, 1.0, 0.95};
    const Verdict verdict = verdict_on(made(7, [&](double level, const Place& at) {
        return gain[at.sensor] * level + 0.5 * kNoise * std::sin(8 * std::numbers::pi * at.grey);
    }));
    CHECK((verdict.decision == Decision::Named || verdict.decision == Decision::CannotTell));
    REQUIRE_FALSE(verdict.causes.empty());
    CHECK(verdict.causes.front().name == "ground_gain");
}

TEST_CASE("single readings far astray, always down, are a structure too") {
    const Verdict verdict = verdict_on(made(8, [](double level, const Place& at) {
        return (at.run * kRows + at.row) % 53 == 0 ? level - 60 * kNoise : level;
    }));
    CHECK(verdict.decision == Decision::Unexplained);
    CHECK(verdict.causes.empty());
}
