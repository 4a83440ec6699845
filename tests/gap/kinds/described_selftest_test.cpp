// The self test of a described kind: a hidden effect is found, nothing is nothing, and what is no effect of
// the kind gets no name; and the test itself sees a kind whose effects are wrong.

#include "gap/kinds/read_kind.h"
#include "selftest/described/described.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace puckloop::gap;
using namespace puckloop::gap::selftest;

TEST_CASE("a sensor that no part of the project knows is told apart by its file alone") {
    const Kind kind = read_kind(PUCKLOOP_SOURCE "/scenarios/kinds/ir_distance.toml");
    DescribedTest test;
    test.cases = 9;
    test.seed = 20260801;
    test.scratch = puckloop::tests::scratch_path("described");
    const auto cases = described_test(kind, test);
    REQUIRE(cases.size() == 9);
    std::string lines;
    for (const DescribedCase& one : cases)
        lines += described_line(one) + "\n";
    INFO(lines << described_text(cases, test));
    const auto count = [&](auto is) { return std::count_if(cases.begin(), cases.end(), is); };
    CHECK(count([](const DescribedCase& one) { return !one.error.empty(); }) == 0);
    CHECK(count([](const DescribedCase& one) { return one.first_right(); }) >= 2);  // of 3
    CHECK(count([](const DescribedCase& one) { return one.wrong(); }) <= 1);
    CHECK(described_met(cases));
    // What is hidden does something, and about what was asked.
    for (const DescribedCase& one : cases)
        CHECK((one.hidden == HiddenIn::Nothing ? one.ratio == 0 : one.ratio > 0.5 && one.ratio < 3.5));
    // The same seed draws the same.
    test.workers = 1;
    const auto again = described_test(kind, test);
    for (std::size_t k = 0; k < cases.size(); ++k)
        CHECK(described_line(again[k]) == described_line(cases[k]));
}

TEST_CASE("names that were not hidden fail the test") {
    std::vector<DescribedCase> cases(20);
    for (std::size_t k = 0; k < 4; ++k)
        cases[k].named = {"gains"};
    CHECK_FALSE(described_met(cases));
    cases.assign(20, {});
    CHECK(described_met(cases));
    cases[3].error = "no";
    CHECK_FALSE(described_met(cases));
}
