// Effects that only scatter, on toy experiments: they are named for scatter, and not for a mean that the
// model lacks or for bursts.

#include "base/random.h"
#include "gap/pipeline/analyse.h"
#include "tests/gap/simulated.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

constexpr int kRuns = 8;

struct Row {
    int run, place, read, row;
};

/// What the simulator gives for each row, in order, with `wrong` on top.
void fill(Experiment& experiment, const char* column, const std::function<double(double, const Row&)>& wrong,
          int reads) {
    test::fill(experiment, column, [&](double simulated, std::uint32_t run, std::uint32_t at) {
        const int row = static_cast<int>(at);
        return wrong(simulated, {static_cast<int>(run), row / reads, row % reads, row});
    });
}

/// Runs whose rows `add` fills; what is measured is the simulator's own, with `wrong` on top.
Experiment toy(Kind kind, const char* column, int rows, int reads, const std::function<void(Run&, int)>& add,
               const std::function<double(double, const Row&)>& wrong) {
    Experiment experiment;
    experiment.kind = kind;
    experiment.title = "toy";
    experiment.instruments[column] = {0, 4095, 1};
    for (int r = 0; r < kRuns; ++r) {
        Run run;
        run.name = "run" + std::to_string(r);
        run.rows = static_cast<std::size_t>(rows);
        for (int k = 0; k < rows; ++k) {
            run.columns["t_s"].push_back(0.1 * k);
            run.columns[column].push_back(1000);
            add(run, k);
        }
        experiment.runs.push_back(std::move(run));
    }
    fill(experiment, column, wrong, reads);
    return experiment;
}

/// One board heard from twenty distances, ten messages each.
Experiment strengths(const std::function<double(double level, const Row&)>& wrong) {
    constexpr int kPlaces = 20, kReads = 10;
    RandomStream random(11, "places of the scatter test");
    double distance = 0.0;
    const auto add = [&](Run& run, int k) {
        if (k % kReads == 0) distance = 0.1 + 0.6 * random.uniform();
        run.columns["distance_m"].push_back(distance);
    };
    const auto counts = [&](double level, const Row& row) { return std::round(std::exp(wrong(level, row))); };
    return toy(Kind::Rab, "strength", kPlaces * kReads, kReads, add, counts);
}

/// Sensors 0 and 6 before a wall at forty distances each, or at fewer that are read more than once, up to
/// `farthest` m.
Experiment readings(const std::function<double(double level, const Row&)>& wrong, int reads = 1,
                    double farthest = 0.03) {
    constexpr int kRows = 80;
    RandomStream random(12, "places of the scatter test");
    double distance = 0.0;
    const auto add = [&](Run& run, int k) {
        if (k % reads == 0) distance = 0.01 + (farthest - 0.01) * random.uniform();
        run.columns["sensor"].push_back(k < kRows / 2 ? 0 : 6);
        run.columns["distance_m"].push_back(distance);
    };
    return toy(Kind::Proximity, "reading", kRows, reads, add, wrong);
}

Verdict verdict_on(const Experiment& experiment) {
    return analyse(experiment, {});
}

}  // namespace

TEST_CASE("strengths that scatter more, message by message, are named so") {
    RandomStream random(13, "scatter test");
    const Verdict verdict =
        verdict_on(strengths([&](double level, const Row&) { return level + 0.4 * random.normal(); }));
    REQUIRE_FALSE(verdict.causes.empty());
    CHECK(verdict.causes.front().name == "range_noise");
}

TEST_CASE("bursts in which nothing is heard do not make scatter of what is heard a mean") {
    RandomStream random(15, "scatter test");
    Experiment experiment =
        strengths([&](double level, const Row&) { return level + 0.4 * random.normal(); });
    for (Run& run : experiment.runs) {
        for (std::size_t k = 0; k < run.rows; ++k) {
            const bool heard = std::fmod(run.columns["t_s"][k], 3.0) > 0.7;  // the same in each run
            run.columns["received"].push_back(heard ? 1 : 0);
            if (!heard) run.columns["strength"][k] = NAN;
        }
    }
    const Verdict verdict = verdict_on(experiment);
    CHECK(verdict.decision == Decision::Named);
    REQUIRE(verdict.causes.size() == 2);
    CHECK(verdict.causes[0].name == "beat_loss");
    CHECK(verdict.causes[1].name == "range_noise");
}

TEST_CASE("strengths that differ from place to place and repeat at each are not scatter") {
    RandomStream random(13, "scatter test");
    double offset = 0.0;
    const Verdict verdict = verdict_on(strengths([&](double level, const Row& row) {
        if (row.read == 0) offset = 0.5 * random.normal();
        return level + offset + 0.12 * random.normal();
    }));
    CHECK(verdict.decision == Decision::Unexplained);
    CHECK(verdict.causes.empty());
}

TEST_CASE("pulses that hit single readings are named, bursts of bad contact are not") {
    RandomStream random(14, "scatter test");
    const auto noisy = [&](double level) {
        return std::clamp(std::round(level + 3 * random.normal()), 0.0, 4095.0);
    };
    const Verdict pulses = verdict_on(readings([&](double level, const Row&) {
        const double hit = random.uniform();
        return noisy(level + (hit < 0.05 ? 150 : hit < 0.1 ? -150 : 0));
    }));
    REQUIRE_FALSE(pulses.causes.empty());
    CHECK(pulses.causes.front().name == "pulsed_interference");
    const Verdict bursts = verdict_on(readings([&](double level, const Row& row) {
        // Six rows in forty, of a contact that lets pass what it likes.
        const bool loose = (row.row + 7 * row.run) % 40 < 6;
        return noisy(loose ? level + 150 * (row.row % 2 == 0 ? 1 : -1) : level);
    }));
    CHECK(bursts.decision == Decision::Unexplained);
    CHECK(bursts.causes.empty());
}

TEST_CASE("noise in proportion errs anew at each reading, what is there again at the next one is none") {
    RandomStream random(15, "scatter test");
    double share = 0.0;
    const auto verdict_of = [&](bool anew) {
        return verdict_on(readings(
            [&](double level, const Row& row) {
                if (anew || row.read == 0) share = 0.01 * random.normal();
                return std::clamp(std::round(level * (1 + share) + 3 * random.normal()), 0.0, 4095.0);
            },
            2, 0.08));
    };
    const Verdict scatter = verdict_of(true);
    REQUIRE(scatter.causes.size() == 1);
    CHECK(scatter.causes.front().name == "proportional_noise");
    const Verdict offsets = verdict_of(false);
    CHECK(offsets.decision == Decision::Unexplained);
    CHECK(offsets.causes.empty());
}

TEST_CASE("a gain that drifts otherwise in each run is no noise that grows with the reading") {
    for (const std::uint64_t seed : {1, 2, 3}) {
        RandomStream random(seed, "scatter test/drifting gain");
        std::array<double, kRuns> phase{};
        for (double& one : phase)
            one = 2 * std::numbers::pi * random.uniform();
        const Verdict verdict = verdict_on(readings([&](double level, const Row& row) {
            const double gain =
                1 + 0.05 * std::sin(0.17 * row.row + phase[static_cast<std::size_t>(row.run)]);
            return std::clamp(std::round(level * gain + 3 * random.normal()), 0.0, 4095.0);
        }));
        CHECK(verdict.decision == Decision::Unexplained);
        CHECK(verdict.causes.empty());
    }
}

TEST_CASE("a cause stays where only scatter beside it is doubted") {
    RandomStream random(16, "scatter test");
    const Verdict verdict = verdict_on(readings([&](double level, const Row& row) {
        const bool loose = (row.row + 7 * row.run) % 40 < 5;
        const double off = loose ? 30 * (row.row % 2 == 0 ? 1 : -1) : 0.0;
        return std::clamp(std::round(level + (row.row < 40 ? 0.0 : 60.0) + off + 3 * random.normal()), 0.0,
                          4095.0);
    }));
    CHECK(verdict.decision == Decision::Named);
    REQUIRE(verdict.causes.size() == 1);
    CHECK(verdict.causes.front().name == "sensor_offset");
    CHECK(std::any_of(verdict.cautions.begin(), verdict.cautions.end(), [](const std::string& caution) {
        return caution.find("pulsed_interference") == 0 && caution.find("bursts") != std::string::npos;
    }));
}
