// Effects hidden in drawn swarms: which are named, which are not, and how often chance alone is taken for
// one. The draw knows what it hid; compare() sees runs only.

#include "base/random.h"
#include "gap/mission/compare.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace puckloop;
using namespace puckloop::gap::mission;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr Index kStatistics = 6;
constexpr std::size_t kEffects = 5;

VectorXd normal_vector(RandomStream& random, Index size) {
    VectorXd vector(size);
    for (Index i = 0; i < size; ++i)
        vector(i) = random.normal();
    return vector;
}

enum class Hidden { Nothing, Known, Unknown };

/// A swarm's statistics: some programs, runs that scatter together, effects that shift every program another
/// way.
struct Case {
    Groups groups;
    std::size_t effect = 0;
    double share = 0.0;
};

Case drawn_case(RandomStream& random, Hidden hidden, std::size_t programs, Index runs) {
    Case one;
    MatrixXd mixing = MatrixXd::Identity(kStatistics, kStatistics);
    for (Index i = 0; i < kStatistics; ++i)
        mixing.row(i) += 0.4 * normal_vector(random, kStatistics).transpose();
    // A change of a condition shifts the means by about one and a half deviations between runs.
    std::vector<std::vector<VectorXd>> shifts(kEffects);
    std::vector<VectorXd> unknown;
    for (std::size_t p = 0; p < programs; ++p) {
        for (auto& effect : shifts) {
            // Programs answer alike in part, in part in their own way.
            const VectorXd common = effect.empty() ? normal_vector(random, kStatistics) : effect.front();
            effect.push_back(p == 0 ? VectorXd(1.5 * common)
                                    : VectorXd(0.7 * common + normal_vector(random, kStatistics)));
        }
        unknown.push_back(1.5 * normal_vector(random, kStatistics));
    }
    one.effect = random.below(kEffects);
    one.share = (random.uniform() < 0.5 ? -1 : 1) * (0.5 + random.uniform());
    const auto group = [&](const VectorXd& mean, Index count) {
        Group sample(count, kStatistics);
        for (Index i = 0; i < count; ++i)
            sample.row(i) = (mean + mixing * normal_vector(random, kStatistics)).transpose();
        return sample;
    };
    one.groups.effects.resize(kEffects);
    for (std::size_t p = 0; p < programs; ++p) {
        const VectorXd base = 3 * normal_vector(random, kStatistics);
        one.groups.simulated.push_back(group(base, 2 * runs));
        for (std::size_t e = 0; e < kEffects; ++e)
            one.groups.effects[e].push_back(group(base + shifts[e][p], 2 * runs));
        VectorXd real = base;
        if (hidden == Hidden::Known) real += one.share * shifts[one.effect][p];
        if (hidden == Hidden::Unknown) real += unknown[p];
        one.groups.measured.push_back(group(real, runs));
    }
    return one;
}

struct Count {
    int cases = 0, named_right = 0, named_wrong = 0, told_apart_not = 0, same = 0, unexplained = 0,
        covered = 0;
};

Count count(Hidden hidden, int cases, std::size_t programs, Index runs) {
    RandomStream random(2026, "gap/mission/test" + std::to_string(static_cast<int>(hidden)) +
                                  std::to_string(programs));
    Count all;
    for (int i = 0; i < cases; ++i) {
        const Case one = drawn_case(random, hidden, programs, runs);
        const Comparison verdict = compare(one.groups, static_cast<std::uint64_t>(i) + 1);
        ++all.cases;
        all.same += verdict.finding == Finding::Same ? 1 : 0;
        all.unexplained += verdict.finding == Finding::Unexplained ? 1 : 0;
        all.told_apart_not += verdict.finding == Finding::CannotTell ? 1 : 0;
        if (verdict.finding != Finding::Named) continue;
        const Amount& first = verdict.together.front();
        const bool right = hidden == Hidden::Known && first.effect == one.effect;
        (right ? all.named_right : all.named_wrong) += 1;
        if (right) all.covered += first.low <= one.share && one.share <= first.high ? 1 : 0;
    }
    return all;
}

/// Upper end of the 95 % interval of a share, by Wilson's formula (one-sided).
double upper(int hits, int of) {
    constexpr double z = 1.645;
    const double n = of, p = hits / n;
    return (p + z * z / (2 * n) + z * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n))) / (1 + z * z / n);
}

double lower(int hits, int of) {
    return 1 - upper(of - hits, of);
}

}  // namespace

TEST_CASE("of drawn swarms with a hidden effect most are named, and few wrongly") {
    const Count known = count(Hidden::Known, 100, 4, 10);
    INFO(known.named_right << " right, " << known.named_wrong << " wrong, " << known.told_apart_not
                           << " not told apart, " << known.unexplained << " unexplained, " << known.same
                           << " same; intervals " << known.covered);
    CHECK(lower(known.named_right, known.cases) > 0.8);
    CHECK(upper(known.named_wrong, known.cases) < 0.05);
    CHECK(lower(known.covered, known.named_right) > 0.75);  // of 90 % intervals
}

TEST_CASE("what no effect does is unexplained") {
    const Count unknown = count(Hidden::Unknown, 100, 4, 10);
    INFO(unknown.named_wrong << " named, " << unknown.unexplained << " unexplained, " << unknown.same
                             << " same");
    CHECK(upper(unknown.named_wrong, unknown.cases) < 0.08);
    CHECK(lower(unknown.unexplained, unknown.cases) > 0.85);
}

TEST_CASE("where nothing is hidden, nothing is found in 19 of 20") {
    const Count nothing = count(Hidden::Nothing, 200, 4, 8);
    INFO(nothing.same << " same, " << nothing.named_wrong << " named");
    CHECK(lower(nothing.same, nothing.cases) > 0.9);
    CHECK(upper(nothing.named_wrong, nothing.cases) < 0.03);
}

TEST_CASE("of one program the halves of its runs take the part of programs") {
    const Count known = count(Hidden::Known, 200, 1, 16);
    INFO(known.named_right << " right, " << known.named_wrong << " wrong, " << known.told_apart_not
                           << " not told apart, " << known.unexplained << " unexplained");
    CHECK(upper(known.named_wrong, known.cases) < 0.08);
    CHECK(lower(known.named_right, known.cases) > 0.55);
}

TEST_CASE("more runs see more, and what would be seen is stated") {
    RandomStream random(7, "visible");
    const Comparison few = compare(drawn_case(random, Hidden::Nothing, 2, 5).groups, 1);
    const Comparison many = compare(drawn_case(random, Hidden::Nothing, 2, 40).groups, 1);
    CHECK(many.visible < 0.6 * few.visible);
}

TEST_CASE("the same runs and seed give the same verdict") {
    RandomStream random(8, "same");
    const Case one = drawn_case(random, Hidden::Known, 3, 8);
    const Comparison a = compare(one.groups, 5), b = compare(one.groups, 5);
    CHECK(a.p == b.p);
    REQUIRE(a.alone.size() == b.alone.size());
    for (std::size_t i = 0; i < a.alone.size(); ++i) {
        CHECK(a.alone[i].gain == b.alone[i].gain);
        CHECK(a.alone[i].low == b.alone[i].low);
    }
}
