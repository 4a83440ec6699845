// Losses that keep to a course are not chance's, however much better any chance of loss is than none.

#include "base/random.h"
#include "gap/decide/no_mechanism.h"
#include "gap/pipeline/analyse.h"
#include "tests/gap/simulated.h"

#include <catch2/catch.hpp>

#include <functional>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

constexpr int kRuns = 6, kRows = 300;
constexpr std::uint64_t kSeed = 20261127;

/// `lost`: the chance that a row's message or frame is, by its run and row.
using Lost = std::function<double(int run, int row)>;

/// Messages from distances in turn.
Experiment messages(std::uint64_t seed, const Lost& lost) {
    RandomStream random(seed, "rate alone test");
    return test::recorded(Kind::Rab, kRuns, kRows, [&](Run& run, int r, int k) {
        run.columns["t_s"].push_back(0.1 * k);
        run.columns["distance_m"].push_back(0.1 * (1 + k * 5 % 7));
        run.columns["received"].push_back(random.uniform() < lost(r, k) ? 0 : 1);
    });
}

/// Frames of a loop that arrive on time.
Experiment frames(std::uint64_t seed, const Lost& lost) {
    RandomStream random(seed, "rate alone test");
    return test::recorded(Kind::Timing, kRuns, kRows, [&](Run& run, int r, int k) {
        const double robot = 0.1 * k + 1e-5 * random.normal();
        run.columns["seq"].push_back(k);
        run.columns["t_robot_s"].push_back(robot);
        run.columns["t_host_s"].push_back(robot + 0.0073 + 4e-4 * random.normal());
        run.columns["bytes"].push_back(84);
        run.columns["frame_ok"].push_back(random.uniform() < lost(r, k) ? 0 : 1);
    });
}

double of_distance(int /*run*/, int row) {
    return 0.03 * (1 + row * 5 % 7);
}

}  // namespace

TEST_CASE("one chance of loss gains over none, and a cause that knows no more gains nothing beyond") {
    const Experiment experiment = messages(kSeed, [](int, int) { return 0.12; });
    const Study study(experiment, 1);
    Selection selection;
    selection.none = study.fit_none();
    selection.held_none = study.hold_out(selection.none);
    const auto& received = study.model().observables().front();
    REQUIRE(received.noise == NoiseKind::Event);
    const double gained = gained_by_rate(study, selection, 0);
    const auto costs = costs_at(study.model(), selection.none.fitted.state,
                                study.model().predicted(selection.none.fitted.state.values));
    double cost = 0.0;
    for (const double one : costs.front().cost)
        cost += one;
    CHECK(gained > 0.3 * kRuns * kRows);  // some 0.5 nats a row
    CHECK(lowered_by_rate(received, cost) > gained);
    CHECK(lowered_by_rate(received, cost) < gained + 5);  // what was learnt on other rows costs a nat or two
}

TEST_CASE("losses by chance are named, losses that grow with distance are unexplained") {
    const Verdict chance = analyse(messages(kSeed, [](int, int) { return 0.12; }));
    CHECK(chance.decision == Decision::Named);
    REQUIRE(chance.causes.size() == 1);
    CHECK(chance.causes.front().name == "random_loss");
    const Verdict course = analyse(messages(kSeed, of_distance));
    CHECK(course.decision == Decision::Unexplained);
    CHECK(course.causes.empty());
}

TEST_CASE("frames lost by chance are named, those lost in turn or in blocks are unexplained") {
    const Verdict chance = analyse(frames(kSeed, [](int, int) { return 0.05; }));
    CHECK(chance.decision == Decision::Named);
    REQUIRE(chance.causes.size() == 1);
    CHECK(chance.causes.front().name == "truncation");
    const Verdict in_turn = analyse(frames(kSeed, [](int, int row) { return row % 10 == 3 ? 1.0 : 0.0; }));
    CHECK(in_turn.decision == Decision::Unexplained);
    CHECK(in_turn.causes.empty());
    const Verdict blocks =
        analyse(frames(kSeed, [](int, int row) { return row / 50 % 2 == 0 ? 0.15 : 0.0; }));
    CHECK(blocks.decision == Decision::Unexplained);
    CHECK(blocks.causes.empty());
}
