// On noise the tests must keep to their level, also when the noise carries over and when runs have offsets of
// their own; otherwise every report would name structure that is not there.

#include "gap/stats/structure.h"
#include "gap/stats/tests.h"
#include "tests/gap/stats/made_series.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>

using namespace puckloop;
using namespace puckloop::gap::stats;
using namespace puckloop::gap::stats::tests;

namespace {

/// Share of `cases` in which p < 0.05.
double alarms(int cases, const std::function<double(RandomStream&, const TestOptions&)>& p_of) {
    int hits = 0;
    for (int i = 0; i < cases; ++i) {
        RandomStream random(static_cast<std::uint64_t>(i), "noise");
        if (p_of(random, {.seed = static_cast<std::uint64_t>(i), .permutations = 199}) < 0.05) ++hits;
    }
    return static_cast<double>(hits) / cases;
}

constexpr int kCases = 300;
// 5 % of 300 is 15 with a standard deviation of 3.8; three deviations above are 26. A block cut from a series
// that carries over keeps a little dependence on its neighbours, hence a little more.
constexpr double kMost = 0.09;

}  // namespace

TEST_CASE("a trend in white noise is found in one case of twenty") {
    const double rate = alarms(kCases, [](RandomStream& random, const TestOptions& options) {
        const Series y = made_noise(4, 40, 0.0, random);
        return trend_test(y, made_covariate(4, 40, 0.0, random), "x", options).p;
    });
    CHECK(rate < kMost);
    CHECK(rate > 0.02);
}

TEST_CASE("even scatter, wild values and all, is called uneven in one case of twenty") {
    const double rate = alarms(kCases, [](RandomStream& random, const TestOptions& options) {
        Series y = made_noise(6, 60, 0.0, random);
        for (double& v : y.value)
            if (random.uniform() < 0.02) v *= 5;
        return evenness_test(y, options).p;
    });
    CHECK(rate < kMost);
    CHECK(rate > 0.02);
}

namespace {

/// Events that come with a chance of `most` times x, x in steps of a fifth, less that chance.
Series made_events(int runs, int rows, double most, std::vector<double>& x, RandomStream& random) {
    Series y;
    y.events = true;
    for (int r = 0; r < runs; ++r)
        for (int i = 0; i < rows; ++i) {
            x.push_back(static_cast<double>(random.below(5)) / 5);
            const double chance = std::max(most * x.back(), 1e-3);
            const double happened = random.uniform() < chance ? 1.0 : 0.0;
            y.value.push_back(happened - chance);
            y.run.push_back(r);
        }
    return y;
}

}  // namespace

TEST_CASE("events that come as often as expected show nothing over what they depend on") {
    const auto rate = [](const auto& test) {
        return alarms(kCases, [&](RandomStream& random, const TestOptions& options) {
            std::vector<double> x;
            const Series y = made_events(8, 100, 0.08, x, random);
            return test(y, x, "x", options).p;
        });
    };
    CHECK(rate(trend_test) < kMost);
    CHECK(rate(shape_test) < kMost);
    CHECK(rate(step_test) < kMost);
}

TEST_CASE("events that come more often where x is high show it") {
    RandomStream random(5, "more events");
    std::vector<double> x;
    Series y = made_events(8, 200, 0.08, x, random);
    for (std::size_t i = 0; i < x.size(); ++i)
        if (x[i] > 0.5 && random.uniform() < 0.06) y.value[i] = 0.94;  // happened
    const TestOptions options{.seed = 1, .permutations = 299};
    CHECK(trend_test(y, x, "x", options).p < 1e-3);
    CHECK(shape_test(y, x, "x", options).p < 1e-3);
}

TEST_CASE("p near what is decided by does not hang on the seed") {
    RandomStream random(3, "near the bound");
    std::vector<double> x = made_covariate(1, 400, 0.0, random);
    Series y = made_noise(1, 400, 0.0, random);
    for (std::size_t i = 0; i < x.size(); ++i)
        y.value[i] += 0.35 * x[i];
    double least = 1.0, most = 0.0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const double p = trend_test(y, x, "x", {.seed = seed, .permutations = 299}).p;
        least = std::min(least, p);
        most = std::max(most, p);
    }
    CHECK(most < 1e-3);
    CHECK(least > 1e-9);
    CHECK(most / least < 12);
}

TEST_CASE("noise and covariate that both wander raise no more trends, shapes or steps than chance") {
    for (const double carry : {0.5, 0.9}) {
        CHECK(alarms(kCases, [&](RandomStream& random, const TestOptions& options) {
                  const Series y = made_noise(6, 150, carry, random);
                  return trend_test(y, made_covariate(6, 150, carry, random), "x", options).p;
              }) < kMost);
        CHECK(alarms(kCases, [&](RandomStream& random, const TestOptions& options) {
                  const Series y = made_noise(6, 150, carry, random);
                  return shape_test(y, made_covariate(6, 150, carry, random), "x", options).p;
              }) < kMost);
        CHECK(alarms(kCases, [&](RandomStream& random, const TestOptions& options) {
                  const Series y = made_noise(6, 150, carry, random);
                  return step_test(y, made_covariate(6, 150, carry, random), "x", options).p;
              }) < kMost);
    }
}

TEST_CASE("runs with offsets of their own do not make a condition of the run look like a cause") {
    const double rate = alarms(kCases, [](RandomStream& random, const TestOptions& options) {
        Series y = made_noise(8, 50, 0.3, random);
        std::vector<double> condition(y.size());
        for (std::size_t i = 0; i < y.size(); ++i)
            condition[i] = y.run[i];
        for (int r = 0; r < 8; ++r) {
            const double offset = 3 * random.normal();
            for (std::size_t i = 0; i < y.size(); ++i)
                if (y.run[i] == r) y.value[i] += offset;
        }
        return trend_test(y, condition, "condition", options).p;
    });
    CHECK(rate < kMost);
    CHECK(rate > 0.01);
}

TEST_CASE("a hundred readings of one placement count as one") {
    // Each of 9 distances has a placement error of its own; the readings scatter little about it.
    const double rate = alarms(kCases, [](RandomStream& random, const TestOptions& options) {
        Series y;
        std::vector<double> distance;
        for (int d = 0; d < 9; ++d) {
            const double placement = random.normal();
            for (int i = 0; i < 100; ++i) {
                y.value.push_back(placement + 0.1 * random.normal());
                y.run.push_back(0);
                distance.push_back(d);
            }
        }
        return trend_test(y, distance, "distance", options).p;
    });
    CHECK(rate < kMost);
    CHECK(rate > 0.01);
}

TEST_CASE("previous sample, spectrum, outliers, spread and sessions keep to their level") {
    CHECK(alarms(kCases, [](RandomStream& random, const TestOptions& options) {
              return serial_test(made_noise(4, 60, 0.0, random), options).p;
          }) < kMost);
    CHECK(alarms(120, [](RandomStream& random, const TestOptions& options) {
              return periodic_test(made_noise(3, 128, 0.0, random), made_time(3, 128, 0.1), options).p;
          }) < 0.11);  // 120 cases: three deviations above 5 %
    CHECK(alarms(120, [](RandomStream& random, const TestOptions& options) {
              return periodic_test(made_noise(3, 128, 0.8, random), made_time(3, 128, 0.1), options).p;
          }) < 0.11);
    CHECK(alarms(kCases, [](RandomStream& random, const TestOptions& options) {
              return outlier_test(made_noise(4, 100, 0.0, random), options).p;
          }) < kMost);
    CHECK(alarms(kCases, [](RandomStream& random, const TestOptions& options) {
              const Series y = made_noise(4, 60, 0.0, random);
              return spread_test(y, made_covariate(4, 60, 0.9, random), "level", options).p;
          }) < kMost);
    CHECK(alarms(kCases, [](RandomStream& random, const TestOptions& options) {
              const Series y = made_noise(8, 30, 0.5, random);
              std::vector<int> session;
              for (const int r : y.run)
                  session.push_back(r / 2);
              return group_test(y, session, "session", {}, options).p;
          }) < kMost);
    CHECK(alarms(kCases, [](RandomStream& random, const TestOptions& options) {
              Series y = made_noise(4, 60, 0.3, random);
              for (double& v : y.value)
                  v = std::round(2 * v);
              return held_test(y, options).p;
          }) < 0.25);  // carry-over itself repeats values; see the next check for independent values
    CHECK(alarms(kCases, [](RandomStream& random, const TestOptions& options) {
              Series y = made_noise(4, 60, 0.0, random);
              for (double& v : y.value)
                  v = std::round(2 * v);
              return held_test(y, options).p;
          }) < kMost);
}

TEST_CASE("a whole table on noise has a false finding in one case of twenty") {
    int hits = 0;
    for (int i = 0; i < 60; ++i) {
        RandomStream random(static_cast<std::uint64_t>(i), "table");
        StructureInput input;
        input.residual = made_noise(5, 60, 0.0, random);
        input.time = made_time(5, 60, 0.1);
        for (const char* name : {"distance", "speed"})
            input.covariates.push_back({name, CovariateKind::Signed, made_covariate(5, 60, 0.9, random), {}});
        const auto table =
            structure_table(input, {.seed = static_cast<std::uint64_t>(i), .permutations = 299});
        CHECK(table.size() == 15);
        for (const Finding& f : table)
            if (f.p_adjusted < 0.05) {
                ++hits;
                break;
            }
    }
    CHECK(hits <= 8);  // 3 expected, deviation 1.7
}

TEST_CASE("a residual that never varies has no structure, whatever rounding makes of its means") {
    RandomStream random(3, "constant");
    StructureInput input;
    input.residual = made_noise(5, 60, 0.0, random);
    for (double& value : input.residual.value)
        value = 0.0316385998584166;
    input.covariates.push_back({"x", CovariateKind::Number, made_covariate(5, 60, 0.0, random), {}});
    CHECK(structure_table(input, {.seed = 1, .permutations = 99}).empty());
}
