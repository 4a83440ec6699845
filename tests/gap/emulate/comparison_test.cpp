#include "selftest/emulate/comparison.h"

#include "base/random.h"

#include <catch2/catch.hpp>

#include <cmath>

using puckloop::RandomStream;
using namespace puckloop::gap::emulate;

TEST_CASE("rows are compared by their errors, chance by its distribution") {
    Comparison rows;
    CHECK_FALSE(rows.off_by());
    rows.error(3);
    rows.error(-4);
    rows.error(NAN);
    CHECK(rows.rows() == 2);
    CHECK(*rows.off_by() == Approx(std::sqrt(12.5)));

    Comparison shift;
    shift.measured(1);
    CHECK_FALSE(shift.off_by());
    for (const double value : {5.0, 1.0, 3.0}) {
        shift.performed(value + 2);
        if (value > 1) shift.measured(value);
    }
    CHECK(*shift.off_by() == Approx(2));  // whatever the order

    Comparison share;  // one of four against one of two
    for (const double value : {1, 0, 0, 0})
        share.measured(value);
    share.performed(1, 0.1);
    share.performed(0, 0.1);
    CHECK(*share.off_by() == Approx(0.25));
}

TEST_CASE("a distribution shows scatter and rare jumps that no row comes back with") {
    RandomStream random(Catch::rngSeed(), "comparison test");
    const auto off = [&](double sd, double jumps) {
        Comparison one;
        for (int k = 0; k < 4000; ++k) {
            const auto value = [&](double spread, double rate) {
                return spread * random.normal() + (random.uniform() < rate ? 10 : 0);
            };
            one.measured(value(2, 0.1));
            one.performed(value(sd, jumps));
        }
        return *one.off_by();
    };
    CHECK(off(2, 0.1) < 0.3);
    CHECK(off(1, 0.1) > 0.5);  // E|2 z - z| is 0.8
    CHECK(off(2, 0.0) > 0.6);  // a tenth of them moved by 10
}

TEST_CASE("the floor's limit holds one more performance of the same robot") {
    const Floor same = floor_of({2, 2, 2, 2});
    CHECK((same.mean == 2 && same.limit == 2));
    RandomStream random(Catch::rngSeed(), "floor test");
    int beyond = 0;
    constexpr int kTries = 4000;
    for (int k = 0; k < kTries; ++k) {
        const auto error = [&] { return 5 + random.normal(); };
        const Floor floor = floor_of({error(), error(), error(), error()});
        beyond += error() > floor.limit ? 1 : 0;
    }
    CHECK(beyond / static_cast<double>(kTries) == Approx(0.05).margin(0.015));
}
