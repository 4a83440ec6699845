// What counts as a difference, faults of the recorded run among it.

#include "tools/replay/comparison.h"

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
