// How long it takes and how often it fails: drawn times against the published ones, and whole exchanges by
// two modules and a host.

#include "emu/bluetooth/exchange.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <vector>

using namespace puckloop;
using namespace puckloop::bluetooth;

namespace {

struct Moments {
    double mean = 0.0, sd = 0.0;
};

Moments moments(const std::vector<double>& values) {
    double sum = 0.0, squares = 0.0;
    for (const double value : values)
        sum += value;
    const double mean = sum / static_cast<double>(values.size());
    for (const double value : values)
        squares += (value - mean) * (value - mean);
    return {mean, std::sqrt(squares / static_cast<double>(values.size() - 1))};
}

}  // namespace

TEST_CASE("drawn times have the mean and deviation asked for", "[bluetooth]") {
    RandomStream choice(50, "spreads");
    for (int round = 0; round < 6; ++round) {
        // Shapes below and above 1.
        const Spread spread{2.0 + 10.0 * choice.uniform(), 0.0};
        const double sd = spread.mean * (0.2 + 1.2 * choice.uniform());
        RandomStream random(51, "draw" + std::to_string(round));
        std::vector<double> values;
        for (int i = 0; i < 20'000; ++i)
            values.push_back(cosim::to_seconds(draw({spread.mean, sd}, random)));
        const Moments of = moments(values);
        // 5 standard errors of the mean; the deviation's error grows with the fourth moment: 8 %.
        CHECK(std::abs(of.mean - spread.mean) < 5 * sd / std::sqrt(20'000.0) + 0.01);
        CHECK(of.sd == Approx(sd).epsilon(0.08));
    }
    RandomStream random(52, "fixed");
    CHECK(draw({3.0, 0.0}, random) == 3 * cosim::kSecond);
    CHECK(draw({0.001, 0.0}, random) == kShortest);
}

TEST_CASE("exchanges take and fail as published: 19.8 +- 4.5 s, 5 of 58 not found", "[bluetooth]") {
    constexpr int kExchanges = 4000;
    std::vector<double> totals, parts;
    int found = 0, linked = 0, arrived = 0;
    for (int i = 0; i < kExchanges; ++i) {
        const Exchange one = exchange({}, 7, static_cast<std::uint64_t>(i));
        found += one.found ? 1 : 0;
        linked += one.linked ? 1 : 0;
        arrived += one.arrived ? 1 : 0;
        CHECK(one.inquiry >= 6.4);
        CHECK(one.inquiry < 6.41);
        if (one.linked) totals.push_back(one.total);
        if (!one.found) CHECK(one.total < 6.42);
    }
    // Once found and linked everything arrives, as all 53 did.
    CHECK(linked == found);
    CHECK(arrived == linked);
    // 53 of 58: 5 standard errors of the share are 2.2 %.
    CHECK(std::abs(found / double{kExchanges} - 53.0 / 58.0) < 0.022);
    const Moments of = moments(totals);
    CHECK(std::abs(of.mean - 19.8) < 0.5);
    CHECK(std::abs(of.sd - 4.5) < 0.3);
    // The same number is the same exchange.
    CHECK(exchange({}, 7, 11).total == exchange({}, 7, 11).total);
    CHECK(exchange({}, 7, 11).total != exchange({}, 8, 11).total);
}
