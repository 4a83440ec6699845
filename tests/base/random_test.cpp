#include "base/random.h"

#include <catch2/catch.hpp>

#include <cmath>

using puckloop::RandomStream;

TEST_CASE("a stream is a function of seed and name only") {
    RandomStream a(7, "robot0.adc");
    RandomStream b(7, "robot0.adc");
    RandomStream other_name(7, "robot1.adc");
    RandomStream other_seed(8, "robot0.adc");
    const auto first = a.next();
    CHECK(first == b.next());
    CHECK(first != other_name.next());
    CHECK(first != other_seed.next());
}

TEST_CASE("normal() has mean 0 and deviation 1") {
    RandomStream stream(1, "test");
    double sum = 0, squares = 0;
    constexpr int n = 100'000;
    for (int i = 0; i < n; ++i) {
        const double x = stream.normal();
        sum += x;
        squares += x * x;
    }
    // Standard errors of mean and variance at n = 1e5 are 0.0032 and 0.0045; five of each.
    CHECK(std::abs(sum / n) < 0.016);
    CHECK(std::abs(squares / n - 1.0) < 0.023);
}

TEST_CASE("below(n) stays below n and reaches every value") {
    RandomStream stream(3, "test");
    bool seen[5] = {};
    for (int i = 0; i < 200; ++i) {
        const auto draw = stream.below(5);
        REQUIRE(draw < 5);
        seen[draw] = true;
    }
    for (bool s : seen)
        CHECK(s);
}
