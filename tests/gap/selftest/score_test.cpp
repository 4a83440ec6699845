// Judging verdicts: a right name counts only when it stands first and was said, an interval only when it
// holds.

#include "selftest/score.h"

#include <catch2/catch.hpp>

using namespace puckloop::gap;
using namespace puckloop::gap::selftest;

namespace {

HiddenCase hidden(Expect expect, std::vector<int> numbers) {
    HiddenCase made;
    made.kind = "motion";
    made.expect = expect;
    made.strength = expect == Expect::NoEffect ? Strength::None : Strength::Medium;
    made.numbers = std::move(numbers);
    made.truths = {{"robot.axle_length", 0.054}};
    return made;
}

Verdict said(Decision decision, std::vector<int> numbers, double low = 0.0, double high = 0.0) {
    Verdict verdict;
    verdict.decision = decision;
    for (const int number : numbers) {
        Cause cause;
        cause.name = "effect" + std::to_string(number);
        cause.number = number;
        cause.parameters = {{"robot.axle_length", "m", 0.053, low, high}};
        verdict.causes.push_back(cause);
    }
    return verdict;
}

double reached(const std::vector<Judged>& cases, const std::string& start) {
    for (const Requirement& r : requirements(cases))
        if (r.what.starts_with(start)) return r.reached;
    return -1;
}

}  // namespace

TEST_CASE("the right name counts when it stands first and is said") {
    CHECK(judge(hidden(Expect::Named, {3}), said(Decision::Named, {3})).first_right);
    CHECK_FALSE(judge(hidden(Expect::Named, {3}), said(Decision::Named, {2, 3})).first_right);
    const Judged drawn = judge(hidden(Expect::Named, {3}), said(Decision::CannotTell, {3}));
    CHECK_FALSE(drawn.first_right);
    CHECK(drawn.ranked_right);
    CHECK(drawn.listed_right);
    Verdict rivals = said(Decision::CannotTell, {2});
    Rival rival;
    rival.cause.number = 3;
    rival.instead_of = "effect2";
    rivals.rivals = {rival};
    CHECK(judge(hidden(Expect::Named, {3}), rivals).listed_right);
}

TEST_CASE("an interval is counted only where the cause was found, and covers or not") {
    CHECK(judge(hidden(Expect::Named, {3}), said(Decision::Named, {3}, 0.0535, 0.0545))
              .estimates.at(0)
              .covered());
    const Judged outside = judge(hidden(Expect::Named, {3}), said(Decision::Named, {3}, 0.0525, 0.0535));
    REQUIRE(outside.estimates.size() == 1);
    CHECK_FALSE(outside.estimates[0].covered());
    CHECK(judge(hidden(Expect::Named, {3}), said(Decision::Named, {2}, 0, 1)).estimates.empty());
}

TEST_CASE("false alarms, unexplained and wrong names are counted apart") {
    std::vector<Judged> cases;
    cases.push_back(judge(hidden(Expect::NoEffect, {}), said(Decision::NoEffect, {})));
    cases.push_back(judge(hidden(Expect::NoEffect, {}), said(Decision::Unexplained, {})));
    cases.push_back(judge(hidden(Expect::Unexplained, {}), said(Decision::Unexplained, {})));
    cases.push_back(judge(hidden(Expect::Unexplained, {}), said(Decision::Named, {4})));
    CHECK(reached(cases, "false alarms") == Approx(0.5));
    CHECK(reached(cases, "unknown effects called") == Approx(0.5));
    CHECK(reached(cases, "unknown effects given") == Approx(0.5));
    const std::string text = report_text(cases, 1);
    CHECK(text.find("MISSED") != std::string::npos);
    CHECK(text.find("unknown") != std::string::npos);
}
