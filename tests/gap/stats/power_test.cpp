// What is there is found, with its size and shape in words.

#include "gap/stats/exchange.h"
#include "gap/stats/structure.h"
#include "gap/stats/tests.h"
#include "tests/gap/stats/made_series.h"

#include <catch2/catch.hpp>

#include <numbers>

using namespace puckloop;
using namespace puckloop::gap::stats;
using namespace puckloop::gap::stats::tests;
using Catch::Matchers::Contains;

namespace {
const TestOptions kOptions{.seed = 7, .permutations = 999};
}

TEST_CASE("a slope under carried-over noise: found, sized, put in words") {
    RandomStream random(1, "slope");
    Series y = made_noise(6, 100, 0.6, random);
    std::vector<double> distance;
    for (std::size_t i = 0; i < y.size(); ++i)
        distance.push_back(static_cast<double>(i % 100) * 0.01);
    for (std::size_t i = 0; i < y.size(); ++i)
        y.value[i] += 3.0 * distance[i];
    const Finding f = trend_test(y, distance, "distance", kOptions);
    CHECK(f.p < 1e-4);
    CHECK(f.effect == Approx(2.7).margin(0.6));  // 90 % of the range of 1
    CHECK_THAT(f.shape, Contains("grows with distance"));
}

TEST_CASE("a distance in 9 steps of one run is enough for a strong trend, not for a wild claim") {
    RandomStream random(2, "steps");
    Series y;
    std::vector<double> distance;
    for (int d = 0; d < 9; ++d)
        for (int i = 0; i < 100; ++i) {
            y.value.push_back(d + 0.2 * random.normal());
            y.run.push_back(0);
            distance.push_back(0.1 * d);
        }
    const Finding f = trend_test(y, distance, "distance", kOptions);
    CHECK(prepared(y, distance).blocks.size() == 9);
    CHECK(f.p <= 0.002);
    CHECK(f.p >= 1.0 / 1000);
    CHECK_THAT(f.shape, Contains("grows with distance, zero at distance = 0"));
}

TEST_CASE("what happens in one half of some runs shows in the scatter, whatever it follows") {
    RandomStream random(4, "uneven");
    Series y = made_noise(8, 100, 0.0, random);
    for (std::size_t i = 0; i < y.size(); ++i)
        if (y.run[i] % 3 == 0 && i % 100 > 50) y.value[i] += 2 * random.normal();
    const Finding f = evenness_test(y, kOptions);
    CHECK(f.p < 1e-6);
    CHECK(f.effect > 1);
}

TEST_CASE("a hump is invisible to the trend and plain to the shape test") {
    RandomStream random(3, "hump");
    Series y = made_noise(5, 80, 0.0, random);
    std::vector<double> angle;
    for (std::size_t i = 0; i < y.size(); ++i)
        angle.push_back(random.uniform() * 2 - 1);
    for (std::size_t i = 0; i < y.size(); ++i)
        y.value[i] += 2 * (1 - angle[i] * angle[i]);
    CHECK(trend_test(y, angle, "angle", kOptions).p > 0.01);
    const Finding f = shape_test(y, angle, "angle", kOptions);
    CHECK(f.p < 1e-4);
    CHECK_THAT(f.shape, Contains("highest near angle"));
}

TEST_CASE("a threshold is found where it is") {
    RandomStream random(4, "threshold");
    Series y = made_noise(4, 100, 0.0, random);
    std::vector<double> speed;
    for (std::size_t i = 0; i < y.size(); ++i)
        speed.push_back(1000 * random.uniform());
    for (std::size_t i = 0; i < y.size(); ++i)
        y.value[i] -= speed[i] > 800 ? 3.0 : 0.0;
    const Finding f = step_test(y, speed, "speed", kOptions);
    CHECK(f.p < 1e-4);
    CHECK(f.effect == Approx(-3.0).margin(0.5));
    CHECK_THAT(f.shape, Contains("steps down at speed"));
    CHECK(std::stod(f.shape.substr(f.shape.rfind(' '))) == Approx(800).margin(25));
}

TEST_CASE("the sign of a command and its reversals are kept apart") {
    RandomStream random(5, "reversal");
    Series y = made_noise(6, 120, 0.0, random);
    std::vector<double> command;
    for (std::size_t i = 0; i < y.size(); ++i)
        command.push_back(i / 20 % 2 == 0 ? 1.0 : -1.0);
    Series by_sign = y, by_reversal = y;
    for (std::size_t i = 0; i < y.size(); ++i) {
        by_sign.value[i] += command[i];
        if (i % 120 >= 20 && i % 20 < 5) by_reversal.value[i] -= 1.5 * command[i];
    }
    std::vector<int> sign;
    for (const double c : command)
        sign.push_back(c > 0 ? 1 : 0);
    const Finding group = group_test(by_sign, sign, "sign of command", {"negative", "positive"}, kOptions);
    CHECK(group.p < 0.002);
    CHECK(group.effect == Approx(2.0).margin(0.3));
    CHECK_THAT(group.shape, Contains("highest positive, lowest negative"));
    CHECK(reversal_test(by_reversal, command, "command", 5, kOptions).p < 0.002);
    CHECK(reversal_test(y, command, "command", 5, kOptions).p > 0.05);
}

TEST_CASE("a line in the spectrum survives coloured noise and uneven time") {
    RandomStream random(6, "line");
    Series y = made_noise(4, 300, 0.7, random);
    std::vector<double> time;
    double t = 0;
    for (std::size_t i = 0; i < y.size(); ++i) {
        t = i % 300 == 0 ? 0 : t + 0.1 * (0.9 + 0.2 * random.uniform());
        time.push_back(t);
        y.value[i] += 0.7 * std::sin(2 * std::numbers::pi * 2.1 * t);
    }
    const Finding f = periodic_test(y, time, kOptions);
    CHECK(f.p < 1e-3);
    CHECK(f.effect == Approx(0.7).margin(0.15));
    CHECK_THAT(f.shape, Contains("oscillates at 2.1"));
}

TEST_CASE("sessions, run order, previous sample, wild values, scatter and held samples") {
    RandomStream random(7, "others");
    Series y = made_noise(12, 40, 0.4, random);
    std::vector<int> session;
    Series jump = y, drift = y;
    for (std::size_t i = 0; i < y.size(); ++i) {
        session.push_back(y.run[i] / 4);
        jump.value[i] += session.back() == 1 ? 3.0 : 0.0;
        drift.value[i] += 0.4 * y.run[i];
    }
    const Finding s = group_test(jump, session, "session", {"mon", "tue", "wed"}, kOptions);
    CHECK(s.p < 0.01);
    CHECK_THAT(s.shape, Contains("highest tue"));
    CHECK(run_order_test(drift, kOptions).p < 0.01);
    const Finding carried = serial_test(y, kOptions);
    CHECK(carried.p < 1e-4);
    CHECK(carried.effect == Approx(0.4).margin(0.1));

    Series wild = made_noise(4, 100, 0.0, random);
    for (std::size_t i = 0; i < wild.size(); i += 20)
        wild.value[i] += i % 40 == 0 ? 30 : -30;
    const Finding w = outlier_test(wild, kOptions);
    CHECK(w.p < 1e-6);
    CHECK(w.effect == Approx(0.05).margin(0.01));
    CHECK_THAT(w.shape, Contains("both sides"));

    Series spread = made_noise(4, 100, 0.0, random);
    std::vector<double> level;
    for (double& v : spread.value)
        level.push_back(random.uniform()), v *= 1 + 3 * level.back();
    const Finding sp = spread_test(spread, level, "level", kOptions);
    CHECK(sp.p < 1e-3);
    CHECK(sp.effect > 0.8);
    CHECK_THAT(sp.shape, Contains("grows with the predicted level"));

    Series held = made_noise(3, 100, 0.0, random);
    for (std::size_t i = 1; i < held.size(); ++i)
        if (i % 5 != 0) held.value[i] = held.value[i - 1];
    const Finding h = held_test(held, kOptions);
    CHECK(h.p < 1e-6);
    CHECK(h.effect == Approx(0.8).margin(0.05));
}

TEST_CASE("tests say when there is too little") {
    const Series y{{1, 2, 3}, {0, 0, 0}};
    CHECK(trend_test(y, {1, 2, 3}, "x", kOptions).p == 1);
    CHECK_THAT(trend_test(y, {1, 2, 3}, "x", kOptions).shape, Contains("too few"));
    CHECK(serial_test(y, kOptions).p == 1);
    CHECK(periodic_test(y, {1, 2, 3}, kOptions).p == 1);
    CHECK(group_test(y, {0, 0, 0}, "session", {"a"}, kOptions).shape == "one session only");
    CHECK(structure_table({y, {}, {}, {}, {}}, kOptions).size() == 4);
}

TEST_CASE("the same seed gives the same table") {
    RandomStream random(8, "seed");
    StructureInput input;
    input.residual = made_noise(4, 50, 0.2, random);
    input.covariates.push_back({"x", CovariateKind::Number, made_covariate(4, 50, 0.2, random), {}});
    const auto a = structure_table(input, kOptions), b = structure_table(input, kOptions);
    REQUIRE(a.size() == b.size());
    for (std::size_t i = 0; i < a.size(); ++i)
        CHECK(a[i].p == b[i].p);
}
