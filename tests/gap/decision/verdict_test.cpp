// What a verdict with rivals says, in a word and in a sentence.

#include "gap/verdict/sentences.h"
#include "gap/verdict/verdict.h"

#include <catch2/catch.hpp>

using namespace puckloop::gap;
using Catch::Matchers::Contains;

namespace {

/// Two causes, the first with ten times the gain; `rival` may stand in the place of `of`.
Verdict with_rival_of(const char* of) {
    Verdict verdict;
    Cause first, second, other;
    first.name = "wheel_scale";
    first.title = "the wheels are larger";
    first.score_gain = 100;
    second.name = "tracker_delay";
    second.title = "the tracker is late";
    second.score_gain = 10;
    other.name = "command_latency";
    other.title = "commands take effect late";
    verdict.causes = {first, second};
    Rival rival;
    rival.cause = other;
    rival.instead_of = of;
    verdict.rivals = {rival};
    verdict.decision = doubtful(verdict) ? Decision::CannotTell : Decision::Named;
    return verdict;
}

}  // namespace

TEST_CASE("a small part in doubt leaves a clear cause clear", "[gap][decision]") {
    Verdict verdict = with_rival_of("tracker_delay");
    CHECK(verdict.decision == Decision::Named);
    CHECK_THAT(summary_of(verdict),
               Contains("wrong because the wheels are larger and the tracker is late (or "
                        "commands take effect late: a small part"));
    verdict.causes[1].score_gain = 50;
    CHECK(doubtful(verdict));
    verdict.decision = Decision::CannotTell;
    CHECK_THAT(summary_of(verdict),
               Contains("because the wheels are larger. Cannot tell whether the tracker "
                        "is late or commands take effect late. None of the experiments"));
}

TEST_CASE("a rival of the first cause makes it doubtful", "[gap][decision]") {
    const Verdict verdict = with_rival_of("wheel_scale");
    CHECK(verdict.decision == Decision::CannotTell);
    CHECK_THAT(summary_of(verdict), Contains("Cannot tell whether the wheels are larger or commands"));
}
