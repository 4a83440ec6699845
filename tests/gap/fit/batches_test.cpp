// Batches in which a host hands frames over: which of them fit alike, and what is none.

#include "base/random.h"
#include "gap/fit/intervals.h"
#include "gap/fit/select.h"
#include "gap/fit/study.h"
#include "gap/identify/robot_clock.h"
#include "tests/gap/candidate.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

constexpr double kHandling = 0.0023;  // s: a frame of three is ready so much later
constexpr int kReads = 12;            // for so many transfers before it

/// Frames of a loop, handed over at multiples of `batch` (s); its period strays by up to `uneven` s.
Experiment batched(double batch, double uneven) {
    Experiment experiment;
    experiment.kind = Kind::Timing;
    experiment.folder = "made";
    experiment.nominal["timing.i2c_stretch"] = kHandling / kReads;
    for (int r = 0; r < 6; ++r) {
        RandomStream random(7, "test/batches " + std::to_string(r));
        Run run;
        run.name = run.file = "run" + std::to_string(r);
        run.rows = 200;
        double robot = 0.0;
        for (int k = 0; k < 200; ++k) {
            const int reads = k % 3 == 0 ? kReads : 0;
            const double ready = 0.132 + robot + reads * kHandling / kReads;
            run.columns["i2c_reads"].push_back(reads);
            run.columns["seq"].push_back(k);
            run.columns["t_robot_s"].push_back(robot);
            run.columns["t_host_s"].push_back(std::ceil(ready / batch) * batch + 1e-4 * random.normal());
            robot += 0.1 + uneven * random.uniform();
        }
        experiment.runs.push_back(std::move(run));
    }
    return experiment;
}

/// Frames every 0.1 s, each so late (s) at the host as `late` draws it, ready at the time that it gets.
Experiment late_frames(double drift, const std::function<double(RandomStream&, double)>& late) {
    Experiment experiment;
    experiment.kind = Kind::Timing;
    experiment.folder = "made";
    for (int r = 0; r < 6; ++r) {
        RandomStream random(11, "test/waits " + std::to_string(r));
        Run run;
        run.name = run.file = "run" + std::to_string(r);
        run.rows = 300;
        for (int k = 0; k < 300; ++k) {
            const double robot = 0.1 * k, ready = robot * (1 + drift) + 0.0123 + 0.001 * r;
            run.columns["seq"].push_back(k);
            run.columns["t_robot_s"].push_back(robot);
            run.columns["t_host_s"].push_back(ready + late(random, ready));
        }
        experiment.runs.push_back(std::move(run));
    }
    return experiment;
}

double exponential(RandomStream& random, double mean) {
    return -mean * std::log(1 - random.uniform());
}

/// Effects that a search finds, in its order, and the values that they are fitted with.
struct Found {
    std::vector<std::string> names;
    std::vector<double> values;
};

Found found_in(const Experiment& experiment) {
    const Study study(experiment, 1);
    const Search::Progress quiet;
    Search search(study, quiet);
    (void)search.first();
    const Selection selection = search.rest();
    Found found;
    for (const auto& step : selection.steps)
        found.names.emplace_back(study.candidates()[step.effect].effect->name);
    for (const auto& freed : selection.chosen.freed)
        found.values.push_back(selection.chosen.fitted.state.values[freed.index]);
    return found;
}

/// The batch as it is fitted, and what else fits as well, s.
std::pair<double, Interval> batch_of(const Experiment& experiment) {
    const Study study(experiment, 1);
    const Fit fit = study.fit_set({candidate(study, "batching")}, study.fit_none().fitted.state);
    return {fit.fitted.state.values[fit.freed[0].index],
            interval_of(study, fit, precision_of(study, fit), 0)};
}

}  // namespace

TEST_CASE("of batches that meet even frames alike all are given", "[gap][fit]") {
    for (const double batch : {0.010, 0.025, 0.05}) {
        const auto [value, interval] = batch_of(batched(batch, 0.0));
        INFO(batch << ": " << value << ", " << interval.low << " to " << interval.high);
        for (const double one : {0.010, 0.025, 0.05, 0.1 / 3}) {
            const auto is = [one](double other) { return std::abs(other - one) < 1e-5; };
            CHECK((is(value) || std::ranges::any_of(interval.as_likely, is)));
            CHECK((interval.low < one + 1e-5 && interval.high > one - 1e-5));
        }
    }
}

TEST_CASE("frames at uneven times part a batch from its multiples and parts", "[gap][fit]") {
    for (const double batch : {0.010, 0.025, 0.05}) {
        const auto [value, interval] = batch_of(batched(batch, 0.003));
        INFO(batch << ": " << value);
        CHECK(std::abs(value - batch) < 1e-5);
        CHECK(interval.as_likely.empty());
    }
}

TEST_CASE("waits of which a few are many times longer are no batches, whatever the clocks do", "[gap][fit]") {
    const auto wait = [](RandomStream& random, double) {
        return exponential(random, random.uniform() < 0.04 ? 0.0065 : 0.00046);
    };
    using Names = std::vector<std::string>;
    CHECK(found_in(late_frames(0.0, wait)).names == Names{});
    CHECK(found_in(late_frames(-137.5e-6, wait)).names == Names{"clock_drift"});
}

TEST_CASE("a frame that waits for more than one batch is of the batch that it came with", "[gap][fit]") {
    constexpr double kBatch = 0.01802;
    const Experiment experiment = late_frames(0.0, [](RandomStream& random, double ready) {
        const double sent = ready + exponential(random, 0.005);
        return std::ceil(sent / kBatch) * kBatch - ready + 1e-4 * random.normal();
    });
    const auto [names, values] = found_in(experiment);
    REQUIRE(names == std::vector<std::string>{"batching"});
    CHECK(values.front() == Approx(kBatch).epsilon(1e-4));
}

TEST_CASE("a clock that is read early or late is no batch, nor is what arrivals owe to a frame's bytes",
          "[gap][fit]") {
    const double of_bytes = GENERATE(0.0, 0.0008);  // s, more or less, of every third frame
    Experiment experiment = late_frames(0.0, [](RandomStream&, double) { return 0.0; });
    RandomStream random(13, "test/misread");
    for (Run& run : experiment.runs) {
        double slow = 0.0;
        for (std::size_t k = 0; k < run.rows; ++k) {
            slow = 0.95 * slow + 1e-4 * random.normal();
            const auto part = random.below(3);
            run.columns["bytes"].push_back(84 + 20.0 * static_cast<double>(part));
            run.columns["t_host_s"][k] +=
                slow + (part == 1 ? of_bytes : 0.0) + run.columns["bytes"][k] / 11520;
            run.columns["t_robot_s"][k] += 1.5e-4 * random.normal();
        }
    }
    const auto names = found_in(experiment).names;
    CHECK(std::ranges::find(names, "batching") == names.end());
}

namespace {

/// Frames each 100 ms, give or take `jitter`; the robot's clock errs by `clock` in each.
Experiment clocked(double jitter, double clock, double step) {
    RandomStream random(7, "clocked frames");
    Experiment experiment;
    experiment.kind = Kind::Timing;
    Run& run = experiment.runs.emplace_back();
    for (int i = 0; i < 400; ++i) {
        const double made = 0.1 * i + jitter * random.normal(), noted = made + clock * random.normal();
        run.columns["seq"].push_back(i);
        run.columns["t_robot_s"].push_back(step > 0 ? std::round(noted / step) * step : noted);
        run.columns["t_host_s"].push_back(made + 0.01 + 5e-4 * random.normal());
        ++run.rows;
    }
    return experiment;
}

}  // namespace

TEST_CASE("a robot's clock that errs is known by arrivals that do not follow it") {
    CHECK(following(clocked(1e-4, 1e-3, 0)).errs());
    CHECK_FALSE(following(clocked(1e-3, 1e-5, 0)).errs());
    CHECK(following(clocked(1e-3, 1e-5, 0)).slope == Approx(1.0).margin(0.1));
    CHECK_FALSE(following(clocked(1e-4, 0, 1e-3)).errs());  // whole milliseconds
    CHECK_FALSE(following(clocked(1e-9, 0, 0)).errs());     // even
}
