#include "base/random.h"
#include "gap/evidence/thresholds.h"
#include "gap/fit/intervals.h"
#include "gap/fit/parallel.h"
#include "gap/fit/select.h"
#include "gap/fit/thinned.h"
#include "tests/gap/candidate.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <cmath>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

/// A whole search.
Selection select(const Study& study) {
    const Search::Progress quiet;
    Search search(study, quiet);
    (void)search.first();
    Selection selection = search.rest();
    search.find_rivals(selection);
    return selection;
}

constexpr double kRow = 0.1, kSd = 3.0;  // s, counts

/// A ground sensor driven over waves of grey: readings late by `lag` s. Formulas of its own: noise carried
/// over, whole counts.
Experiment drives(std::uint64_t seed, double lag, std::size_t runs = 6, std::size_t rows = 60) {
    Experiment experiment;
    experiment.kind = Kind::Ground;
    experiment.folder = "made";
    experiment.instruments["reading"] = {0.0, 967.0, 1.0};
    for (std::size_t r = 0; r < runs; ++r) {
        RandomStream random(seed, "test/drive " + std::to_string(r));
        Run run;
        run.name = run.file = "run" + std::to_string(r);
        run.conditions["floor"] = r < runs / 2 ? "a" : "b";
        run.rows = rows;
        const double speed = 0.03 + 0.02 * static_cast<double>(r % 3), begin = random.uniform();
        double last = 0.0;
        for (std::size_t k = 0; k < rows; ++k) {
            const double t = kRow * static_cast<double>(k), x = begin + speed * t;
            const auto grey = [](double place) { return 0.5 + 0.3 * std::sin(40 * place); };
            last = 0.4 * last + std::sqrt(1 - 0.16) * random.normal();
            run.columns["t_s"].push_back(t);
            run.columns["sensor"].push_back(0);
            run.columns["grey"].push_back(grey(x));
            run.columns["grey_rate"].push_back(12 * std::cos(40 * x));
            run.columns["speed"].push_back(speed);
            run.columns["noise"].push_back(kSd * last);
            run.columns["reading"].push_back(0.0);
        }
        experiment.runs.push_back(std::move(run));
    }
    // Black and white as the model has them, so that without lag nothing is wrong.
    const auto model = make_model(experiment);
    const double black = model->neutral()[*model->find("ground.black")];
    const double white = model->neutral()[*model->find("ground.white")];
    for (Run& run : experiment.runs)
        for (std::size_t k = 0; k < run.rows; ++k) {
            const double grey =
                run.columns["grey"][k] - lag * run.columns["speed"][k] * run.columns["grey_rate"][k];
            run.columns["reading"][k] = std::round(black + (white - black) * grey + run.columns["noise"][k]);
        }
    return experiment;
}

}  // namespace

TEST_CASE("90 % intervals hold the truth in about 90 of 100 small experiments", "[gap][fit]") {
    constexpr double kLag = 0.02;  // s
    int held = 0;
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
        const Experiment experiment = drives(seed, kLag, 8, 40);
        const Study study(experiment, seed);
        const Fit none = study.fit_none();
        const Fit fit = study.fit_set({candidate(study, "ground_lag")}, none.fitted.state);
        const Precision precision = precision_of(study, fit);
        const double value = fit.fitted.state.values[fit.freed[0].index];
        held += std::abs(value - kLag) <= precision.quantile * precision.sd[0] ? 1 : 0;
    }
    CHECK(held >= 82);
    CHECK(held <= 97);
}

TEST_CASE("a dead band lies between the last speed that moved nothing and the first that did", "[gap][fit]") {
    constexpr double kStep = 2 * std::numbers::pi * 0.0205 / 1000;
    Experiment experiment;
    experiment.kind = Kind::Motion;
    experiment.folder = "made";
    for (int r = 0; r < 6; ++r) {
        RandomStream random(3, "test/crawl " + std::to_string(r));
        Run run;
        run.name = run.file = "run" + std::to_string(r);
        double x = 0.0;
        for (const double speed : {20.0, 40.0, 50.0, 80.0, 0.0})  // of the agenda's staircase
            for (int k = 0; k < 12; ++k) {
                run.columns["t_s"].push_back(kRow * static_cast<double>(run.rows++));
                run.columns["x_m"].push_back(x + 1.5e-4 * random.normal());
                run.columns["y_m"].push_back(1.5e-4 * random.normal());
                run.columns["theta_rad"].push_back(3e-4 * random.normal());
                run.columns["cmd_left"].push_back(speed);
                run.columns["cmd_right"].push_back(speed);
                if (speed > 45) x += speed * kStep * kRow;
            }
        experiment.runs.push_back(std::move(run));
    }
    const Study study(experiment, 1);
    const Fit fit = study.fit_set({candidate(study, "deadband")}, study.fit_none().fitted.state);
    const Interval interval = interval_of(study, fit, precision_of(study, fit), 0);
    INFO(interval.low << " to " << interval.high);
    CHECK(interval.low > 38);
    CHECK(interval.low < 45);
    CHECK(interval.high > 45);
    CHECK(interval.high < 53);
}

TEST_CASE("what shows in few runs is clear when a second one bears out the best", "[gap][fit]") {
    std::vector<double> two(32, 0.0);
    two[3] = 7.0, two[9] = 5.4;
    CHECK(gain_of(two).in_several());
    // The same two, while the others lose by it what the second gains.
    std::vector<double> eaten = two;
    for (std::size_t i = 16; i < 20; ++i)
        eaten[i] = -0.9;
    CHECK(gain_of(eaten).clearly_better == 2);
    CHECK(gain_of(eaten).clearly_worse == 0);
    CHECK_FALSE(gain_of(eaten).in_several());
    std::vector<double> one(32, 0.0);
    one[3] = 20.0;
    CHECK_FALSE(gain_of(one).in_several());
    // A cause is asked for as much without the best run as it has to gain at all: its standard error over
    // runs, most of which cannot show it, says nothing.
    constexpr std::size_t kEffects = 16;
    std::vector<double> rare(28, -0.1);
    rare[3] = 2000.0, rare[9] = 12.0;
    CHECK(gain_of(rare).sum < thresholds::kStandardErrors * gain_of(rare).sd);
    CHECK(gains_enough(gain_of(rare), kEffects, 1));
    CHECK_FALSE(gains_enough(gain_of(two), kEffects, 1));
    rare[5] = -4.0;  // a run speaks against it
    CHECK_FALSE(gains_enough(gain_of(rare), kEffects, 1));
    CHECK_FALSE(gains_enough(gain_of(one), kEffects, 1));
}

TEST_CASE("selection takes nothing from data without effects", "[gap][fit]") {
    int taken = 0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        const Experiment experiment = drives(seed, 0.0);
        taken += select(Study(experiment, seed)).steps.empty() ? 0 : 1;
    }
    CHECK(taken <= 1);
}

TEST_CASE("selection names a hidden lag, the same on any number of threads", "[gap][fit]") {
    const Experiment experiment = drives(7, 0.1);
    const Study alone(experiment, 1), many(experiment, 1, 3);
    const Selection first = select(alone), second = select(many);
    REQUIRE_FALSE(first.steps.empty());
    CHECK(alone.candidates()[first.steps[0].effect].effect->name == std::string("ground_lag"));
    REQUIRE(second.steps.size() == first.steps.size());
    for (std::size_t k = 0; k < first.steps.size(); ++k) {
        CHECK(second.steps[k].effect == first.steps[k].effect);
        CHECK(second.steps[k].delta_bic == first.steps[k].delta_bic);
        CHECK(second.steps[k].held.sum == first.steps[k].held.sum);
    }
    CHECK(second.chosen.fitted.state.values == first.chosen.fitted.state.values);
}

TEST_CASE("runs are held out whole, and not all of one condition at once", "[gap][fit]") {
    const Experiment experiment = drives(1, 0.0, 6, 20);
    const Study study(experiment, 4);
    CHECK(study.folds() == 5);
    CHECK(study.blocks().count == 6);
    const auto& observable = study.model().observables()[0];
    std::vector<std::set<int>> of_run(6);
    std::set<int> of_first, of_second;
    for (std::size_t i = 0; i < observable.y.size(); ++i) {
        of_run[observable.run[i]].insert(study.fold_of()[0][i]);
        (observable.run[i] < 3 ? of_first : of_second).insert(study.fold_of()[0][i]);
        CHECK(study.blocks().of[0][i] == observable.run[i]);
    }
    for (const auto& folds : of_run)
        CHECK(folds.size() == 1);
    CHECK(of_first.size() == 3);
    CHECK(of_second.size() == 3);
}

TEST_CASE("what only two runs show is never held out in both at once", "[gap][fit]") {
    Experiment experiment = drives(1, 0.0, 6, 20);
    for (Run& run : experiment.runs)
        run.conditions.clear();
    for (const std::size_t r : {1, 4})  // nothing says that these stand
        for (const char* column : {"grey", "grey_rate"})
            experiment.runs[r].columns[column].assign(20, column == std::string("grey") ? 0.4 : 0.0);
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
        const Study study(experiment, seed);
        const auto& observable = study.model().observables()[0];
        std::vector<int> fold(6);
        for (std::size_t i = 0; i < observable.y.size(); ++i)
            fold[observable.run[i]] = study.fold_of()[0][i];
        INFO("seed " << seed);
        CHECK(fold[1] != fold[4]);
    }
}

TEST_CASE("a single run is cut into blocks and stretches", "[gap][fit]") {
    const Experiment experiment = drives(1, 0.0, 1, 160);
    const Study study(experiment, 1);
    CHECK(study.folds() == 5);
    CHECK(study.blocks().count == 16);
    std::set<int> folds(study.fold_of()[0].begin(), study.fold_of()[0].end());
    CHECK(folds.size() == 5);
}

TEST_CASE("work side by side is done once each, and its first failure is thrown on", "[gap][fit]") {
    const unsigned threads = GENERATE(1U, 4U);
    std::vector<std::atomic<int>> done(50);
    in_parallel(50, threads, [&](std::size_t k) { ++done[k]; });
    for (const auto& one : done)
        CHECK(one == 1);
    CHECK_THROWS_WITH(in_parallel(9, threads,
                                  [](std::size_t k) {
                                      if (k >= 3) throw std::runtime_error(std::to_string(k));
                                  }),
                      "3");
}

TEST_CASE("a part of many rows comes from all over every run", "[gap][fit]") {
    const Experiment experiment = drives(2, 0.0, 5, 2000);
    const Experiment part = thinned(experiment, 3000);
    CHECK(part.rows() >= 2700);
    CHECK(part.rows() <= 3300);
    std::set<std::string> names;
    std::set<int> tenths;  // of a run
    for (const Run& run : part.runs) {
        names.insert(run.name);
        const auto& t = run.column("t_s");
        REQUIRE(t.size() == run.rows);
        tenths.insert(static_cast<int>(t.front() / (200 * kRow)));
        CHECK(t.back() - t.front() == Approx(kRow * static_cast<double>(run.rows - 1)));
    }
    CHECK(names.size() == 5);
    CHECK(tenths.size() >= 8);
}

TEST_CASE("many rows are looked at in part first, and say what few say", "[gap][fit]") {
    const Experiment few = drives(7, 0.1, 6, 100), many = drives(7, 0.1, 6, 1400);
    CHECK(Study(few, 1).part() == nullptr);
    const Study study(many, 1, 2);
    REQUIRE(study.part() != nullptr);
    REQUIRE(study.part()->candidates().size() == study.candidates().size());
    const std::size_t lag = candidate(study, "ground_lag");
    const Fit none = study.fit_none();
    const Fit guess = study.part()->fit_set({lag}, study.in_part(none.fitted.state), kQuick);
    const Fit whole = study.from_part(guess, none.fitted.state);
    const auto index = whole.freed[0].index;
    CHECK(whole.fitted.state.values[index] == Approx(0.1).margin(0.01));
    CHECK(study.in_part(whole.fitted.state).values.size() == study.part()->model().parameters().size());
    const Selection selection = select(study);
    REQUIRE_FALSE(selection.steps.empty());
    CHECK(selection.steps[0].effect == lag);
    // Also what was looked at in part only has its figure.
    for (const Trial& trial : selection.trials)
        CHECK((!trial.remark.empty() || trial.delta_bic != 0.0));
}
