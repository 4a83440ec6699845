// The forward model of timing against frames made by other formulas.

#include "gap/sync/sync.h"
#include "tests/gap/models/exact_tables.h"
#include "tests/gap/models/made_table.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

using namespace puckloop::gap;
using selftest::TimingKnobs;

namespace {

constexpr double kRounding = 2e-6;  // s: tables have nine digits

Exact<TimingKnobs> exact(const TimingKnobs& knobs, const char* name) {
    return {selftest::timing_rig(), knobs, name};
}

}  // namespace

TEST_CASE("with nothing wrong frames come when the model has them") {
    const auto rest = exact({}, "timing_rest");
    CHECK(rest.misfit("robot_clock", {}) < kRounding);
    CHECK(rest.misfit("arrival", {}) < kRounding);
}

TEST_CASE("each effect of timing moves the model as it moves the frames") {
    TimingKnobs drift, stretch, longer;
    drift.drift = 1e-3;
    stretch.i2c_stretch = 1e-4;
    longer.longer = 1e-3;
    const auto drifted = exact(drift, "timing_drift");
    CHECK(drifted.misfit("arrival", {}) > 3e-3);
    CHECK(drifted.misfit("arrival", {{"timing.clock_drift", 1e-3}}) < kRounding);
    const auto stretched = exact(stretch, "timing_stretch");
    CHECK(stretched.misfit("arrival", {}) > 3e-4);
    CHECK(stretched.misfit("arrival", {{"timing.i2c_stretch", 1e-4}}) < kRounding);
    const auto slow = exact(longer, "timing_longer");
    CHECK(slow.misfit("robot_clock", {}) > 0.05);
    CHECK(slow.misfit("robot_clock", {{"timing.extra_period", 1e-3}}) < kRounding);
    CHECK(slow.misfit("arrival", {}) < kRounding);  // the wire is as fast as it was
}

TEST_CASE("batches are found by the grid that arrivals keep to") {
    for (const double batch : {0.0016, 0.0017578125, 0.0031, 0.017}) {
        INFO(batch);
        TimingKnobs knobs;
        knobs.batch = batch;
        const auto table = exact(knobs, "timing_batch");
        const auto starts = table.model().starts("timing.batch");
        REQUIRE_FALSE(starts.empty());
        CHECK(std::any_of(starts.begin(), starts.end(),
                          [&](double start) { return std::abs(start - batch) < 1e-5 * batch; }));
        CHECK(table.misfit("arrival", {}) > 0.2 * batch);
        // Below 3 ms the mean of both deliveries is expected of a frame that is ready near one, by a clock
        // good to s = 0.1 ms: over even waits that alone leaves sqrt(0.234 s / batch) = 0.12 of the batch.
        const double left = batch < 0.003 ? 0.15 : 0.1;
        CHECK(table.misfit("arrival", {{"timing.batch", batch}}) < left * batch);
    }
    CHECK(exact({}, "timing_no_batch").model().starts("proximity.gain").empty());
}

TEST_CASE("each row knows how many its chain lacks before it") {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const auto steps_of = [](const tests::Table& columns) {
        const auto experiment = tests::experiment_of(Kind::Timing, columns);
        return make_model(experiment)->observables().front().steps;
    };
    using Steps = std::vector<std::uint32_t>;
    CHECK(steps_of({{"t_host_s", {0.0, 0.1, 0.2, 0.3}}, {"seq", {0, 1, 4, 5e6}}}) ==
          Steps{1, 1, 3, 1'000'000});
    // In the table, and without a time.
    CHECK(steps_of({{"t_host_s", {0.0, kNone, 0.2, 0.3}}}) == Steps{1, 2, 1});
}

TEST_CASE("a loop that paused after broken frames counts its periods anew") {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const auto paused = [](double pause, bool broken) {
        tests::Table columns;
        for (int k = 0; k < 40; ++k) {
            columns["seq"].push_back(k);
            columns["nominal_period"].push_back(0.1);
            const bool missing = broken && (k == 18 || k == 19);
            columns["t_host_s"].push_back(missing ? kNone : 0.1 * k + (k < 20 ? 0.0 : pause));
            columns["frame_ok"].push_back(missing ? 0 : 1);
        }
        auto experiment = tests::experiment_of(Kind::Timing, columns);
        find_pauses(experiment);
        return experiment;
    };
    const auto worst = [](const Experiment& experiment) {
        const auto model = make_model(experiment);
        Prediction prediction;
        model->predict(model->neutral(), prediction);
        double most = 0.0;
        for (std::size_t i = 0; i < prediction[0].mean.size(); ++i)
            most = std::max(most, std::abs(model->observables()[0].y[i] - prediction[0].mean[i]));
        return most;
    };
    const auto found = paused(0.67, true);
    CHECK(found.runs[0].begun_anew == std::vector<std::size_t>{20});
    REQUIRE(found.cautions.size() == 1);
    CHECK_THAT(found.cautions[0], Catch::Contains("(1 times in 1 of 1 runs, for 0.67 to 0.67 s)"));
    CHECK(worst(found) < 1e-9);
    // Late frames, or a pause that no broken frame comes before, are for the causes to explain.
    for (const auto& [pause, broken] : {std::pair{0.04, true}, std::pair{0.67, false}}) {
        const auto left = paused(pause, broken);
        CHECK(left.runs[0].begun_anew.empty());
        CHECK(left.cautions.empty());
        CHECK(worst(left) > pause / 3);
    }
}

TEST_CASE("a program that gives answers up breaks those frames that wait longest for their batch") {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN(), kBatch = 0.031, kLimit = 0.022;
    tests::Table columns;
    for (int k = 0; k < 150; ++k) {
        const double ready = 0.1 * k + 0.0073, slot = std::ceil(ready / kBatch) * kBatch;
        const bool late = slot - ready > kLimit;
        columns["seq"].push_back(k);
        columns["t_host_s"].push_back(late ? kNone : slot);
        columns["frame_ok"].push_back(late ? 0 : 1);
    }
    const auto experiment = tests::experiment_of(Kind::Timing, columns);
    const auto model = make_model(experiment);
    REQUIRE(model->observables()[1].name == "frame_ok");
    const auto& whole = model->observables()[1].y;
    const auto wrong = [&](double limit) {
        Prediction prediction;
        auto values = model->neutral();
        values.at(*model->find("timing.batch")) = kBatch;
        values.at(*model->find("timing.answer_limit")) = limit;
        model->predict(values, prediction);
        int count = 0;
        for (std::size_t i = 0; i < whole.size(); ++i)
            count += std::abs(whole[i] - prediction[1].mean[i]) > 0.5 ? 1 : 0;
        return count;
    };
    const auto broken = static_cast<int>(std::count(whole.begin(), whole.end(), 0.0));
    CHECK(broken > 30);
    CHECK(wrong(0.0) == broken);  // no limit: all whole
    CHECK(wrong(kLimit) <= 1);
    CHECK(wrong(0.5 * kLimit) > 20);
    // A fit begins where as many frames would be broken as are.
    const auto limits = model->starts("timing.answer_limit"), batches = model->starts("timing.batch");
    REQUIRE(limits.size() == batches.size());
    for (std::size_t k = 0; k < limits.size(); ++k)
        CHECK(limits[k] == Approx(batches[k] * (150 - broken) / 150.0));
}

TEST_CASE("a frame after a broken one is broken more often, or less") {
    const auto experiment =
        tests::experiment_of(Kind::Timing, {{"t_host_s", {0.0, 0.1, 0.2, 0.3}}, {"frame_ok", {1, 0, 0, 1}}});
    const auto model = make_model(experiment);
    const auto whole = [&](double cut, double burst) {
        return tests::predicted(*model, {{"timing.truncation", cut}, {"timing.truncation_burst", burst}})
            .back()
            .mean;
    };
    const auto bursts = whole(0.2, 0.5), spared = whole(0.2, -0.5), all = whole(1.0, -0.5);
    CHECK(bursts[1] == Approx(0.8).margin(0.002));  // after a whole one
    CHECK(bursts[2] == Approx(0.4).margin(0.002));  // 0.8 (1 - 0.5)
    CHECK(spared[1] == Approx(0.8).margin(0.002));
    CHECK(spared[3] == Approx(0.9).margin(0.002));  // 1 - 0.2 (1 - 0.5)
    CHECK(all[1] == Approx(0.0).margin(0.002));
    CHECK(all[2] == Approx(0.5).margin(0.002));
}

TEST_CASE("over missing frames a chain of broken ones goes on unseen") {
    // Every frame after a whole one is broken, and half of those after a broken one.
    const auto chain = [](const tests::Table& columns) {
        const auto experiment = tests::experiment_of(Kind::Timing, columns);
        const auto model = make_model(experiment);
        return tests::predicted(*model, {{"timing.truncation", 1.0}, {"timing.truncation_burst", -0.5}})
            .back()
            .mean;
    };
    const tests::Table counted{
        {"t_host_s", {0.0, 0.1, 0.3, 0.6}}, {"frame_ok", {1, 0, 1, 1}}, {"seq", {0, 1, 3, 6}}};
    const auto whole = chain(counted);
    CHECK(whole[1] == Approx(0.0).margin(0.002));
    CHECK(whole[2] ==
          Approx(0.25).margin(0.002));  // broken two before: between them whole (then 0) or broken
    CHECK(whole[3] == Approx(0.25).margin(0.002));  // whole three before
    // A frame that is there but not known to be whole is one that is missing, too.
    const double none = std::numeric_limits<double>::quiet_NaN();
    const auto unknown = chain({{"t_host_s", {0.0, 0.1, 0.2, 0.3}}, {"frame_ok", {1, 0, none, 1}}});
    REQUIRE(unknown.size() == 3);
    CHECK(unknown[2] == Approx(0.25).margin(0.002));
}
