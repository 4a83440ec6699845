// Posterior-predictive checks: quiet where the model made the data, loud at the discrepancy that is there.

#include "base/random.h"
#include "gap/predictive/check.h"
#include "gap/predictive/posterior.h"
#include "gap/residuals/main_covariates.h"
#include "gap/stats/robust.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

constexpr double kSd = 3.0;  // counts

/// What is added to a reading: run, row, the noise of the row (sd 1).
using Wrong = std::function<double(std::size_t, std::size_t, double)>;

/// A ground sensor over waves of grey with white noise in whole counts, and something wrong.
Experiment floors(std::uint64_t seed, const Wrong& wrong) {
    Experiment experiment;
    experiment.kind = Kind::Ground;
    experiment.folder = "made";
    experiment.instruments["reading"] = {0.0, 2000.0, 1.0};
    for (std::size_t r = 0; r < 8; ++r) {
        RandomStream random(seed, "test/floor " + std::to_string(r));
        Run run;
        run.name = run.file = "run" + std::to_string(r);
        run.rows = 80;
        for (std::size_t k = 0; k < run.rows; ++k) {
            run.columns["t_s"].push_back(0.1 * static_cast<double>(k));
            run.columns["sensor"].push_back(0);
            run.columns["grey"].push_back(0.5 +
                                          0.3 * std::sin(0.37 * static_cast<double>(k) + random.uniform()));
            const double noise = random.normal();
            run.columns["reading"].push_back(kSd * noise + wrong(r, k, noise));
        }
        experiment.runs.push_back(std::move(run));
    }
    const auto model = make_model(experiment);
    const auto of = [&](const char* name) { return model->neutral()[*model->find(name)]; };
    for (Run& run : experiment.runs)
        for (std::size_t k = 0; k < run.rows; ++k)
            run.columns["reading"][k] = std::round(
                of("ground.black") + (of("ground.white") - of("ground.black")) * run.columns["grey"][k] +
                run.columns["reading"][k]);
    return experiment;
}

std::vector<PredictiveCheck> checked(const Experiment& experiment, unsigned threads = 1) {
    const Study study(experiment, 1, threads);
    return predictive_checks(study, study.fit_none(), false, 7);
}

const PredictiveCurve& curve_named(const std::vector<PredictiveCheck>& checks, const std::string& name) {
    for (const PredictiveCurve& curve : checks.front().curves)
        if (curve.name == name) return curve;
    throw std::logic_error("no such curve");
}

constexpr const char* kNames[] = {"marginal law", "autocorrelation", "grey", "spread per run"};

}  // namespace

TEST_CASE("a bearing is held against its receiver, as its model names both", "[gap][predictive]") {
    Experiment experiment;
    experiment.kind = Kind::Rab;
    Run run;
    for (int k = 0; k < 40; ++k) {
        run.columns["distance_m"].push_back(0.1 + 0.01 * k);
        run.columns["true_bearing_rad"].push_back(0.1 * k);
        run.columns["bearing_rad"].push_back(0.1 * k + 0.01 * (k % 3));
        run.columns["receiver"].push_back(k % 12);
        run.columns["senders"].push_back(1 + k % 4);
        ++run.rows;
    }
    experiment.runs.assign(4, run);
    const auto model = make_model(experiment);
    const auto bearing = std::ranges::find(model->observables(), "bearing", &Observable::name);
    REQUIRE(bearing != model->observables().end());
    const std::vector<stats::Covariate> all{{"senders", stats::CovariateKind::Number, {}, {}},
                                            {"receiver", stats::CovariateKind::Label, {}, {}}};
    CHECK(main_covariates(experiment, bearing->name, all, bearing->row).front().name == "receiver");
    CHECK(main_covariates(experiment, "strength", all, bearing->row).front().name == "senders");
}

TEST_CASE("where the model made the data, few p values are small", "[gap][predictive]") {
    const std::uint64_t seed = Catch::rngSeed();
    int small = 0, all = 0;
    for (std::uint64_t k = 0; k < 20; ++k)
        for (const PredictiveCheck& check : checked(floors(seed + k, [](auto, auto, auto) { return 0.0; })))
            for (const PredictiveCurve& curve : check.curves) {
                ++all;
                small += curve.p <= 0.05 ? 1 : 0;
            }
    REQUIRE(all >= 80);
    INFO("seed " << seed);
    CHECK(small <= all / 6);  // 5 % of 100 and four standard errors; a fitted model's are fewer
}

TEST_CASE("what is wrong shows at its own discrepancy", "[gap][predictive]") {
    struct Case {
        const char* name;
        Wrong wrong;
    };
    const Case cases[] = {
        {"marginal law", [](auto, std::size_t k, double) { return k % 2 == 0 ? 8 * kSd : -8 * kSd; }},
        {"autocorrelation", [](auto, std::size_t k, double) { return k / 4 % 2 == 0 ? 2 * kSd : -2 * kSd; }},
        {"grey",
         [](auto, std::size_t k, double) { return 3 * kSd * std::sin(0.37 * static_cast<double>(k)); }},
        {"spread per run", [](std::size_t r, auto, double noise) { return r == 3 ? 4 * kSd * noise : 0.0; }}};
    for (const Case& one : cases) {
        const auto checks = checked(floors(Catch::rngSeed(), one.wrong));
        INFO(one.name << ", seed " << Catch::rngSeed());
        const PredictiveCurve& curve = curve_named(checks, one.name);
        CHECK(curve.p <= 0.01);
        bool outside = false;
        for (std::size_t k = 0; k < curve.x.size(); ++k)
            outside = outside || curve.measured[k] < curve.low[k] || curve.measured[k] > curve.high[k];
        CHECK(outside);
    }
}

TEST_CASE("a check is the same for any number of threads", "[gap][predictive]") {
    const Experiment experiment = floors(Catch::rngSeed(), [](auto, auto, auto) { return 0.0; });
    const auto one = checked(experiment, 1), three = checked(experiment, 3);
    for (const char* name : kNames) {
        const PredictiveCurve &a = curve_named(one, name), &b = curve_named(three, name);
        CHECK(a.p == b.p);
        CHECK(a.low == b.low);
        CHECK(a.high == b.high);
        CHECK(a.measured.size() == a.x.size());
    }
}

TEST_CASE("states drawn from the posterior spread as the data lets them", "[gap][predictive]") {
    const Experiment experiment = floors(Catch::rngSeed(), [](auto, auto, auto) { return 0.0; });
    const Study study(experiment, 1);
    const Fit none = study.fit_none();
    RandomStream random(Catch::rngSeed(), "test/posterior");
    std::vector<double> log_sd;
    for (const State& state : posterior_states(study.model(), {}, none.fitted.state, 400, random))
        log_sd.push_back(state.noise[0].log_sd);
    // Of n normal values ln sd is known to 1 / sqrt(2 n); heavier tails that are possible widen it.
    const double known = 1 / std::sqrt(2.0 * static_cast<double>(study.rows()));
    CHECK(stats::standard_deviation(log_sd) > 0.6 * known);
    CHECK(stats::standard_deviation(log_sd) < 3 * known);
    CHECK(stats::mean(log_sd) == Approx(none.fitted.state.noise[0].log_sd).margin(4 * known));
}
