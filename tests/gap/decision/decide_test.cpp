// The decision follows from its grounds; the criterion holds its size; an effect's form is told from its
// neighbours' where the data can, and scatter is not what differs from run to run.

#include "base/random.h"
#include "gap/decide/decide.h"
#include "gap/decide/roles.h"
#include "gap/evidence/criterion.h"
#include "gap/evidence/thresholds.h"
#include "gap/fit_test/rival_forms.h"
#include "gap/pipeline/analyse.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

Grounds sound() {
    Grounds g;
    g.causes = 1;
    g.candidates = 20;
    g.gain.sum = 100;
    g.gain.sd = 20;
    return g;
}

/// Drives over patches of grey: six runs, `wrong` of level, run and way.
Experiment drives(std::uint64_t seed, int runs,
                  const std::function<double(double level, double grey, int run)>& wrong) {
    RandomStream random(seed, "decide test");
    Experiment experiment;
    experiment.kind = Kind::Ground;
    experiment.instruments["reading"] = {0, 967, 1};
    for (int r = 0; r < runs; ++r) {
        Run run;
        run.name = "run" + std::to_string(r);
        run.rows = 120;
        for (std::size_t k = 0; k < run.rows; ++k) {
            const double grey = 0.1 + 0.75 * random.uniform();
            run.columns["t_s"].push_back(0.1 * static_cast<double>(k));
            run.columns["grey"].push_back(grey);
            run.columns["reading"].push_back(
                std::round(wrong(329 + (953 - 329) * grey, grey, r) + 3 * random.normal()));
        }
        experiment.runs.push_back(std::move(run));
    }
    return experiment;
}

}  // namespace

TEST_CASE("a name stands on every ground, and never beside no gain") {
    CHECK(decision_of(sound(), doubt_of(sound())) == Decision::Named);
    const std::function<void(Grounds&)> against[] = {
        [](Grounds& g) { g.gain.sd = 80; },
        [](Grounds& g) { g.gain.sum = 4; },
        [](Grounds& g) { g.in_rounding = true; },
        [](Grounds& g) { g.error_falls = false; },
        [](Grounds& g) { g.assumed = "distance_m"; },
        [](Grounds& g) { g.left_by_shape = 40; },
        [](Grounds& g) { g.sums = true, g.left_of_readings = g.left_by_shape = 40; },
        [](Grounds& g) { g.left_by_structure = 40; },
        [](Grounds& g) { g.left_by_run = 40; },
        [](Grounds& g) { g.stopped_at_end = g.structure = true; },
        [](Grounds& g) { g.out_of_role = "gains by larger errors"; },
        [](Grounds& g) { g.not_confirmed = "leaves something"; },
    };
    for (const auto& one : against) {
        Grounds g = sound();
        one(g);
        CHECK_FALSE(doubt_of(g).empty());
        CHECK(decision_of(g, doubt_of(g)) != Decision::Named);
    }
    Grounds rounded = sound();
    rounded.in_rounding = true;
    CHECK(decision_of(rounded, doubt_of(rounded)) == Decision::NoEffect);
    rounded.structure = true;
    CHECK(decision_of(rounded, doubt_of(rounded)) == Decision::Unexplained);
    Grounds rival = sound();
    rival.rival = true;
    CHECK(decision_of(rival, "") == Decision::CannotTell);
    RandomStream random(1, "decide test/any");
    for (int k = 0; k < 2000; ++k) {
        Grounds g;
        g.causes = random.below(3);
        g.candidates = 1 + random.below(30);
        g.gain.sum = 60 * random.uniform() - 10;
        g.gain.sd = 30 * random.uniform();
        g.left_by_shape = 10 * random.uniform() - 5;
        g.sums = random.uniform() < 0.5;
        g.structure = random.uniform() < 0.5;
        const Decision decision = decision_of(g, doubt_of(g));
        if (decision != Decision::Named) continue;
        CHECK(gains_enough(g.gain, g.candidates, g.causes));
        CHECK(g.gain.sum > thresholds::kStandardErrors * g.gain.sd);
    }
}

TEST_CASE("a structure counts by what its p value may stand for at most") {
    CHECK(most_by_structure({}) == 0.0);
    CHECK(most_by_structure({{"reading", "grey", 0.005, ""}}) == 0.0);
    CHECK(most_by_structure({{"reading", "grey", 2e-4, ""}}) == 0.0);
    // Sellke, Bayarri and Berger 2001: a p of 1e-5 stands for odds of 3195 to one at most.
    CHECK(most_by_structure({{"reading", "grey", 0.005, ""}, {"reading", "time", 1e-5, ""}}) ==
          Approx(std::log(3195.3)).epsilon(1e-3));
    CHECK(most_by_structure({{"reading", "time", 0.0, ""}}) > 600);
}

TEST_CASE("what rounding may do by itself is no cause, what goes beyond it is one") {
    const auto kept_to_steps = [](double offset, double half = 0.5) {
        Experiment experiment = drives(4, 12, [=](double level, double, int) { return level + offset; });
        experiment.instruments["reading"].quantum = 4;
        for (Run& run : experiment.runs)
            for (double& reading : run.columns["reading"])
                reading =
                    4 * std::floor(reading / 4 + half);  // half way: up, 0.5 counts too high in the mean
        return analyse(experiment);
    };
    const Verdict rounding = kept_to_steps(0.4), more = kept_to_steps(3.5), cut_off = kept_to_steps(0.0, 0.0);
    CHECK(rounding.decision == Decision::NoEffect);
    CHECK(cut_off.causes.empty());  // half a step too low
    CHECK(more.decision == Decision::Named);
    CHECK(more.causes.at(0).name == "ground_gain");
}

TEST_CASE("commands lost in two runs of many are named, in one they are not", "[gap][decide]") {
    // In so many runs: one command lost, or wheels that stand still for a row while they are commanded.
    const auto lost_in = [](int runs, bool still = false) {
        constexpr double kRow = 0.1, kSpeed = 500, kStep = std::numbers::pi * 0.041 / 1000;
        Experiment experiment;
        experiment.kind = Kind::Motion;
        experiment.nominal["inverse_friction"] = 0.0;
        for (int r = 0; r < 16; ++r) {
            RandomStream random(17, "lost commands " + std::to_string(r));
            Run run;
            run.name = "run" + std::to_string(r);
            double counted = 0.0;
            for (int k = 0; k < 120; ++k) {
                const auto command = [](int row) { return row / 20 % 2 == 0 ? kSpeed : 0.0; };
                run.columns["t_s"].push_back(kRow * k);
                run.columns["x_m"].push_back(counted * kStep + 1e-3 * random.normal());
                run.columns["y_m"].push_back(1e-3 * random.normal());
                run.columns["theta_rad"].push_back(5e-3 * random.normal());
                for (const char* wheel : {"left", "right"}) {
                    run.columns[std::string("cmd_") + wheel].push_back(command(k));
                    run.columns[std::string("steps_") + wheel].push_back(counted);
                }
                const bool here = r % 3 == 1 && r / 3 < runs && k == (still ? 47 : 20 * (r % 5 + 1));
                counted += kRow * (here && still ? 0.0 : command(here ? k - 1 : k));
                ++run.rows;
            }
            experiment.runs.push_back(std::move(run));
        }
        return analyse(experiment);
    };
    const Verdict two = lost_in(2);
    INFO(two.summary);
    CHECK(two.decision == Decision::Named);
    REQUIRE(two.causes.size() == 1);
    CHECK(two.causes[0].name == "command_loss");
    CHECK(lost_in(2, true).decision != Decision::Named);
    CHECK(lost_in(1).decision != Decision::Named);
    CHECK(lost_in(0).decision == Decision::NoEffect);
}

TEST_CASE("beside batches a drift that moves none of their rows by a slope is not named", "[gap][decide]") {
    constexpr double kPeriod = 0.03, kBatch = 0.0064, kDrift = 376e-6, kWait = 0.0034;
    Experiment experiment;
    experiment.kind = Kind::Timing;
    for (int r = 0; r < 8; ++r) {
        RandomStream random(23, "batches and a drift " + std::to_string(r));
        Run run;
        run.name = "run" + std::to_string(r);
        run.rows = 160;
        for (int k = 0; k < 160; ++k) {
            const double sent = kPeriod * k * (1 + kDrift) + 0.1 - kWait * std::log(1 - random.uniform());
            run.columns["seq"].push_back(k);
            run.columns["nominal_period"].push_back(kPeriod);
            run.columns["t_robot_s"].push_back(kPeriod * k);
            run.columns["t_host_s"].push_back(std::ceil(sent / kBatch) * kBatch + 1e-4 * random.normal());
        }
        experiment.runs.push_back(std::move(run));
    }
    const Verdict verdict = analyse(experiment);
    INFO(verdict.summary);
    REQUIRE(verdict.decision == Decision::Named);
    CHECK(verdict.causes.size() == 1);
    CHECK(verdict.causes.front().name == "batching");
    CHECK(std::ranges::any_of(verdict.cautions, [](const std::string& one) {
        return one.starts_with("clock_drift would have to be part of it");
    }));
}

TEST_CASE("the best of a catalogue meets the criterion by chance as seldom as is claimed") {
    // Held-out scores of one number more where it is nothing: z^2/2 - (z - e)^2/2 with an error e of fitting.
    RandomStream random(2, "criterion");
    constexpr int kCases = 2000, kEffects = 20, kBlocks = 16;
    int taken = 0;
    for (int c = 0; c < kCases; ++c) {
        bool any = false;
        for (int e = 0; e < kEffects; ++e) {
            std::vector<double> gains;
            for (int b = 0; b < kBlocks; ++b) {
                const double fitted = random.normal() / std::sqrt(kBlocks), score = random.normal();
                gains.push_back(score * fitted - fitted * fitted / 2);
            }
            any = any || gains_enough(gain_of(gains), kEffects, 1);
        }
        taken += any ? 1 : 0;
    }
    CHECK(taken < kCases * thresholds::kFalseAlarm);
    CHECK(needed_gain(20, 2) == Approx(std::log(190 / 0.05)));
}

TEST_CASE("an effect's own form is kept, a bent one is seen") {
    const auto told = [](const std::function<double(double)>& wrong) {
        const Experiment experiment =
            drives(3, 6, [&](double level, double grey, int) { return level + wrong(grey); });
        const Study study(experiment, 1);
        for (std::size_t i = 0; i < study.candidates().size(); ++i) {
            if (study.candidates()[i].effect->name != std::string_view("ground_gain")) continue;
            const Fit fit = study.fit_set({i}, study.fit_none().fitted.state);
            return form_verdict(rival_forms(study, fit, i));
        }
        throw std::logic_error("no such effect");
    };
    // Gain and offset: a straight line in grey, of both signs.
    const FormVerdict straight = told([](double grey) { return 60 * (grey - 0.5); });
    CHECK(straight.better.empty());
    CHECK(std::find(straight.open.begin(), straight.open.end(), "its square") == straight.open.end());
    const FormVerdict bent = told([](double grey) { return 200 * (grey - 0.5) * std::abs(grey - 0.5) * 2; });
    CHECK(bent.better == "its square");
    CHECK(bent.left > 20);
}

TEST_CASE("what differs from run to run is neither an effect nor nothing") {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        RandomStream random(seed, "decide test/surfaces");
        std::vector<double> gain;
        for (int r = 0; r < 8; ++r)
            gain.push_back(1 + 0.04 * random.normal());
        const Verdict verdict = analyse(drives(seed, 8,
                                               [&](double level, double, int run) {
                                                   return level * gain[static_cast<std::size_t>(run)];
                                               }),
                                        {});
        CHECK(verdict.decision == Decision::Unexplained);
        CHECK(verdict.causes.empty());
        CHECK(std::any_of(verdict.leftovers.begin(), verdict.leftovers.end(), [](const Leftover& one) {
            return one.shape.find("from run to run") != std::string::npos;
        }));
    }
}

TEST_CASE("a step in one run is not nothing") {
    Experiment experiment = drives(4, 6, [](double level, double, int) { return level; });
    for (std::size_t k = 70; k < 120; ++k)
        experiment.runs[2].columns["reading"][k] += 42;
    const Verdict verdict = analyse(experiment, {});
    CHECK(verdict.decision == Decision::Unexplained);
    CHECK(std::any_of(verdict.leftovers.begin(), verdict.leftovers.end(),
                      [](const Leftover& one) { return one.shape.find("jumps by") != std::string::npos; }));
}
