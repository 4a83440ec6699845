// How errors follow each other while a term is learnt.

#include "base/random.h"
#include "gap/extension/errors_law.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numeric>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

struct Made {
    std::vector<double> error;
    std::vector<char> known, starts;
};

Made made(bool sums, double number, std::uint64_t seed, int runs = 6, int rows = 400) {
    RandomStream random(seed, "errors");
    Made all;
    for (int r = 0; r < runs; ++r) {
        double kept = 0.0;
        for (int i = 0; i < rows; ++i) {
            if (sums) {
                kept += std::sqrt(number) * random.normal();
                all.error.push_back(2.0 * (kept + random.normal()));
            } else {
                kept = i == 0 ? random.normal() / std::sqrt(1 - number * number)
                              : number * kept + random.normal();
                all.error.push_back(2.0 * kept);
            }
            all.known.push_back(1);
            all.starts.push_back(i == 0 ? 1 : 0);
        }
    }
    return all;
}

}  // namespace

TEST_CASE("the law of errors that carry over, or wander, is found", "[gap][extension]") {
    for (const double carry : {0.0, 0.6, 0.92}) {
        const Made one = made(false, carry, 3);
        const ErrorsLaw law = law_of(false, one.error, one.known, one.starts);
        CHECK(law.number == Approx(carry).margin(0.15));
        CHECK(law.sd == Approx(2.0).epsilon(0.1));
    }
    for (const double walk : {0.0, 0.01, 0.3}) {
        const Made one = made(true, walk, 4);
        const ErrorsLaw law = law_of(true, one.error, one.known, one.starts);
        CHECK(law.number == Approx(walk).margin(0.3 * walk + 2e-3));
        CHECK(law.sd == Approx(2.0).epsilon(0.1));
    }
}

TEST_CASE("innovations are white, and rows that say nothing make none", "[gap][extension]") {
    Made one = made(false, 0.85, 5);
    for (std::size_t i = 50; i < 60; ++i)
        one.known[i] = 0;
    ErrorsLaw law;
    law.number = 0.85;
    std::vector<double> z = one.error;
    Whitening(law, one.known, one.starts).apply(z);
    CHECK(z[55] == 0.0);
    double squares = 0.0, products = 0.0;
    for (std::size_t i = 100; i < z.size(); ++i) {
        squares += z[i] * z[i];
        products += z[i] * z[i - 1];
    }
    CHECK(std::sqrt(squares / static_cast<double>(z.size() - 100)) == Approx(2.0).epsilon(0.05));
    CHECK(std::abs(products / squares) < 0.06);
}

TEST_CASE("costs of rows are what the density makes of them", "[gap][extension]") {
    const Made one = made(true, 0.1, 6);
    ErrorsLaw right = law_of(true, one.error, one.known, one.starts), wrong = right;
    wrong.number = 10.0;
    const auto sum = [&](const ErrorsLaw& law) {
        const auto costs = row_costs_of(law, one.error, one.known, one.starts);
        return std::accumulate(costs.begin(), costs.end(), 0.0);
    };
    CHECK(sum(right) < sum(wrong) - 20);
    right.sd *= 3;
    CHECK(sum(right) > sum(law_of(true, one.error, one.known, one.starts)) + 100);
}
