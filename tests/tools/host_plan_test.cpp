// Which host each robot goes to.

#include "base/random.h"
#include "run/plan/host_plan.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <set>

using namespace puckloop;
using namespace puckloop::tools;

TEST_CASE("two groups of robots that no light joins are two parts") {
    std::vector<StandingUnit> units;
    for (int i = 0; i < 5; ++i) {
        units.push_back({0.1 * i, 0.05, 2.0});
        units.push_back({5.0 + 0.1 * i, 0.0, 2.0});
    }
    const std::vector<unsigned> parts = parts_of(units, 2);
    for (std::size_t i = 0; i < units.size(); ++i)
        CHECK(parts[i] == (units[i].x < 1.0 ? 0 : 1));
}

TEST_CASE("a cut goes where the gap is, if the work stays about even") {
    std::vector<StandingUnit> units;
    for (const double y : {0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.5})
        units.push_back({0.0, y, 1.0});
    const std::vector<unsigned> even = parts_of(units, 2);
    CHECK(std::count(even.begin(), even.end(), 0U) >= 4);  // 0.8 to 1.5 m would leave one alone
    CHECK(std::count(even.begin(), even.end(), 1U) >= 4);
    units[5].y += 0.02;
    units[6].y += 0.04;
    const std::vector<unsigned> moved = parts_of(units, 2);
    CHECK(moved[4] == 0);
    CHECK(moved[5] == 1);
}

TEST_CASE("every part has robots as long as there are some, and none of them is too large") {
    RandomStream random(7, "places");
    for (int round = 0; round < 200; ++round) {
        const auto robots = 1 + random.below(40);
        const auto count = static_cast<unsigned>(1 + random.below(12));
        std::vector<StandingUnit> units;
        for (std::uint64_t i = 0; i < robots; ++i)
            units.push_back({3 * random.uniform(), 3 * random.uniform(), 1.0});
        const std::vector<unsigned> parts = parts_of(units, count);
        const std::set<unsigned> used(parts.begin(), parts.end());
        CHECK(*used.rbegin() < count);
        if (robots >= 4 * count) CHECK(used.size() == count);
        for (const unsigned part : used) {
            const auto here = static_cast<double>(std::count(parts.begin(), parts.end(), part));
            // Each of at most four cuts may be a tenth off, and a robot.
            CHECK(here <= 2.2 * static_cast<double>(robots) / count + 4);
        }
        CHECK(parts == parts_of(units, count));
    }
}

TEST_CASE("robots in one place, and none, are no trouble") {
    CHECK(parts_of({}, 3).empty());
    const std::vector<StandingUnit> same(6, {1.0, 1.0, 1.0});
    const std::vector<unsigned> parts = parts_of(same, 3);
    for (unsigned part = 0; part < 3; ++part)
        CHECK(std::count(parts.begin(), parts.end(), part) >= 1);
}
