// What differs from run to run, jumps that stay inside a run, and where a fit was stopped: each seen where it
// is, and not where noise only carries over.

#include "base/random.h"
#include "gap/fit/study.h"
#include "gap/fit_test/run_differences.h"
#include "gap/models/rab_ring.h"
#include "gap/pipeline/weigh.h"
#include "physics/description/parameters.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <numbers>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

constexpr int kRuns = 8, kRows = 150;
constexpr double kSd = 3.0;

/// Ground readings of a still floor of several greys, errors carried over by `carry`.
Experiment floors(std::uint64_t seed, double carry,
                  const std::function<double(double level, int run, int row)>& wrong) {
    RandomStream random(seed, "differences test");
    Experiment experiment;
    experiment.kind = Kind::Ground;
    experiment.instruments["reading"] = {0, 967, 1};
    for (int r = 0; r < kRuns; ++r) {
        Run run;
        run.name = "run" + std::to_string(r);
        run.rows = kRows;
        double error = random.normal();
        for (int k = 0; k < kRows; ++k) {
            error = carry * error + std::sqrt(1 - carry * carry) * random.normal();
            const double grey = 0.3 + 0.4 * random.uniform();
            run.columns["t_s"].push_back(0.1 * k);
            run.columns["grey"].push_back(grey);
            run.columns["reading"].push_back(std::round(wrong(329 + (953 - 329) * grey, r, k) + kSd * error));
        }
        experiment.runs.push_back(std::move(run));
    }
    return experiment;
}

/// Messages between boards of which each run has a pair of its own, with parts as the simulator draws them;
/// `other`: sd of an offset of each run beside it, ln counts.
Experiment pairs_of_boards(std::uint64_t seed, double other) {
    constexpr int kPairs = 24, kMessages = 60;
    const physics::IrParameters parameters = physics::Parameters().ir;
    RandomStream random(seed, "differences test/boards");
    Experiment experiment;
    experiment.kind = Kind::Rab;
    experiment.nominal["rab.ring"] = 1;
    for (int r = 0; r < kPairs; ++r) {
        Run run;
        run.name = "run" + std::to_string(r);
        run.rows = kMessages;
        std::vector<RabLook> looks;
        for (int k = 0; k < kMessages; ++k) {
            const auto way = [&] { return std::numbers::pi * (2 * random.uniform() - 1); };
            const double bearing = way(), facing = way();
            looks.push_back({0.15, bearing, facing});
        }
        const RabRing ring(looks, parameters, 0.0);
        RabParts parts = ring.neutral();
        for (std::size_t k = 0; k < kRabParts; ++k) {
            parts.emitter[k] = std::exp(parameters.emitter_spread * random.normal());
            parts.receiver[k] = std::exp(parameters.receiver_spread * random.normal());
        }
        const double offset = other * random.normal();
        for (int k = 0; k < kMessages; ++k) {
            const RabReading reading = (*ring.readings(parts))[static_cast<std::size_t>(k)];
            const RabLook& look = looks[static_cast<std::size_t>(k)];
            run.columns["t_s"].push_back(0.1 * k);
            run.columns["distance_m"].push_back(look.distance);
            run.columns["true_bearing_rad"].push_back(look.bearing);
            run.columns["sender_bearing_rad"].push_back(look.facing);
            run.columns["strength"].push_back(
                std::exp(reading.log_strength + offset + 0.05 * random.normal()));
            run.columns["bearing_rad"].push_back(reading.bearing + 0.02 * random.normal());
        }
        experiment.runs.push_back(std::move(run));
    }
    return experiment;
}

struct Seen {
    RunDifference difference;
    ChangePoint jump;
};

Seen looked_at(const Experiment& experiment) {
    const Study study(experiment, 1);
    const Fit fit = study.fit_none();
    const auto differences = run_differences(study.model(), fit.fitted.state);
    const auto jumps = change_points(study.model(), fit.fitted.state);
    REQUIRE_FALSE(differences.empty());
    REQUIRE_FALSE(jumps.empty());
    return {differences.front(), jumps.front()};
}

}  // namespace

TEST_CASE("runs that differ are not taken for noise that carries over") {
    int alarms = 0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed)
        for (const double carry : {0.0, 0.8}) {
            const auto seen = looked_at(floors(seed, carry, [](double level, int, int) { return level; }));
            alarms += seen.difference.p_value < 0.01 ? 1 : 0;
            alarms += seen.jump.p_value < 0.01 ? 1 : 0;
        }
    CHECK(alarms <= 2);  // of 48, by chance one half
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        RandomStream random(seed, "differences test/runs");
        std::vector<double> gain, offset;
        for (int r = 0; r < kRuns; ++r) {
            gain.push_back(1 + 0.02 * random.normal());
            offset.push_back(4 * random.normal());
        }
        const auto surfaces = looked_at(floors(seed, 0.4, [&](double level, int run, int) {
            return level * gain[static_cast<std::size_t>(run)];
        }));
        CHECK(surfaces.difference.p_value < 1e-4);
        CHECK(surfaces.difference.gain > 5);
        CHECK(surfaces.difference.shape.find("from run to run") != std::string::npos);
        const auto boards = looked_at(floors(seed, 0.0, [&](double level, int run, int) {
            return level + offset[static_cast<std::size_t>(run)];
        }));
        CHECK(boards.difference.p_value < 1e-4);
        CHECK(boards.difference.gain > 5);
    }
}

TEST_CASE("boards that differ as the simulator's do are no difference between runs, others are") {
    int alarms = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        const Study study(pairs_of_boards(Catch::rngSeed() + seed, 0.0), 1);
        for (const auto& one : run_differences(study.model(), study.fit_none().fitted.state))
            alarms += one.p_value < 1e-3 ? 1 : 0;
    }
    CHECK(alarms <= 1);  // of 18 or more
    const auto seen = looked_at(pairs_of_boards(Catch::rngSeed(), 0.3)).difference;
    CHECK(seen.observable == "strength");
    CHECK(seen.p_value < 1e-4);
    CHECK(seen.gain > 5);
}

TEST_CASE("a jump inside one run that stays is found where it is") {
    for (const double jump : {14 * kSd, -6 * kSd}) {
        const auto seen = looked_at(floors(5, 0.4, [&](double level, int run, int row) {
            return run == 3 && row >= 90 ? level + jump : level;
        }));
        CHECK(seen.jump.p_value < 1e-6);
        CHECK(seen.jump.run == 3);
        CHECK(std::abs(static_cast<int>(seen.jump.row) - 90) <= 3);
        CHECK(seen.jump.jump == Approx(jump).epsilon(0.8));
    }
}

TEST_CASE("a range over decades ends where its logarithm does") {
    CHECK(std::isnan(range_end(25, 20, 2000, 300)));
    CHECK(range_end(20.01, 20, 2000, 300) == 20);
    CHECK(range_end(1999, 20, 2000, 300) == 2000);
    CHECK(range_end(-0.0799, -0.08, 0.08, 0.0) == -0.08);
    CHECK(std::isnan(range_end(0.0, 0.0, 0.5, 0.0)));
    CHECK(range_end(0.4999, 0.0, 0.5, 0.0) == 0.5);
    CHECK(std::isnan(range_end(0.9999, 0.0, 1.0, 0.0)));  // all of a share
}

TEST_CASE("runs that lose differently are described by the shares of their rows") {
    constexpr int kPairs = 8, kMessages = 200;
    RandomStream random(Catch::rngSeed(), "differences test/losses");
    Experiment experiment;
    experiment.kind = Kind::Rab;
    for (int r = 0; r < kPairs; ++r) {
        Run run;
        run.name = "run" + std::to_string(r);
        run.rows = kMessages;
        for (int k = 0; k < kMessages; ++k) {
            run.columns["t_s"].push_back(0.1 * k);
            run.columns["distance_m"].push_back(0.3);
            const bool lost = r == 3 ? k % 2 == 0 : random.uniform() < 0.02;
            run.columns["received"].push_back(lost ? 0 : 1);
        }
        experiment.runs.push_back(std::move(run));
    }
    const Study study(experiment, 1);
    const auto all = run_differences(study.model(), study.fit_none().fitted.state);
    REQUIRE_FALSE(all.empty());
    const RunDifference& seen = all.front();
    CHECK(seen.observable == "received");
    CHECK_THAT(seen.shape, Catch::Contains("differs from run to run: happens in 50 % to 9") &&
                               Catch::Contains("% of a run's rows") && !Catch::Contains("logit"));
}
