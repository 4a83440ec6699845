// What counts as a difference, faults of the recorded run among it.

#include "replay/comparison.h"

#include <catch2/catch.hpp>

using namespace puckloop::cosim;
using puckloop::tools::SentComparison;

namespace {

TraceRow row(Time time, std::uint16_t data, FaultKind fault = FaultKind::None) {
    return {time, "wire", "board", "", fault, UartFrame{time - 900, 100, data}};
}

}  // namespace

TEST_CASE("the first difference is named with its message") {
    SentComparison sent;
    for (Time time : {1000, 2000, 3000})
        sent.recorded(row(time, 7));
    sent.replayed(row(1000, 7));
    sent.replayed(row(2000, 8));
    const auto found = sent.check(3000);
    REQUIRE(found);
    CHECK(found->message == 2);
    CHECK(found->time == 2000);
    CHECK(sent.equal() == 1);
    CHECK_THAT(found->recorded, Catch::Contains(",07,"));
    CHECK_THAT(found->replayed, Catch::Contains(",08,"));
}

TEST_CASE("a message too few or too many is a difference once its time has passed") {
    SentComparison few;
    few.recorded(row(1000, 7));
    CHECK_FALSE(few.check(1000));
    REQUIRE(few.check(1001));
    CHECK(few.check(1001)->replayed.empty());
    SentComparison many;
    many.replayed(row(1000, 7));
    CHECK_FALSE(many.check(1000));
    REQUIRE(many.check(1001));
    CHECK(many.check(1001)->recorded.empty());
}

TEST_CASE("what a fault did to a message is no difference of its sender") {
    for (const FaultKind kind :
         {FaultKind::Drop, FaultKind::Flip, FaultKind::Delay, FaultKind::Rate, FaultKind::Cut}) {
        SentComparison sent;
        sent.recorded(row(1000, kind == FaultKind::Flip ? 6 : 7, kind));
        sent.replayed(row(1000, 7));
        sent.recorded(row(2000, 9));
        sent.replayed(row(2000, 9));
        CHECK_FALSE(sent.check(3000));
        CHECK(sent.equal() == 1);
    }
    SentComparison twice;
    twice.recorded(row(1000, 7, FaultKind::Duplicate));
    twice.recorded(row(2000, 7, FaultKind::Duplicate));
    twice.replayed(row(1000, 7));
    CHECK_FALSE(twice.check(3000));
}

TEST_CASE("on a link with faults messages may be late, behind others, and none may be missing") {
    SentComparison sent({"wire"});
    for (int i = 1; i <= 5; ++i)
        sent.replayed(row(1000 * i, static_cast<std::uint16_t>(i)));
    // The second one is recorded behind the fourth, the fifth not at all: the record ends before.
    sent.recorded(row(1000, 1));
    sent.recorded(row(3000, 3));
    sent.recorded(row(4000, 4));
    CHECK_FALSE(sent.check(5000));
    sent.recorded(row(4900, 2, FaultKind::Delay));
    CHECK_FALSE(sent.check(6000));
    CHECK_FALSE(sent.finish(6000));
    CHECK(sent.equal() == 3);
    // What never comes was never sent.
    const auto missing = sent.finish(5000 + 2 * kSecond);
    REQUIRE(missing);
    CHECK(missing->time == 5000);
    // What was sent otherwise is found as ever.
    SentComparison other({"wire"});
    other.replayed(row(1000, 7));
    other.recorded(row(1000, 8));
    REQUIRE(other.check(2000));
    CHECK(other.check(2000)->time == 1000);
}
