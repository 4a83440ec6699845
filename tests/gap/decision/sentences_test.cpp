// The verdict in words.

#include "gap/verdict/sentences.h"

#include <catch2/catch.hpp>

using namespace puckloop::gap;
using Catch::Matchers::Contains;

TEST_CASE("a narrow interval is told with digits enough to see its ends") {
    FittedParameter axle;
    axle.name = "robot.axle_length";
    axle.unit = "m";
    axle.value = 0.0539996, axle.low = 0.0539953, axle.high = 0.0540038;
    Cause cause;
    cause.title = "the wheels stand further apart";
    cause.parameters = {axle};
    CHECK_THAT(cause_sentence(cause), Contains("= 54 mm (53.995 mm to 54.004 mm)."));
    cause.parameters[0].low = 0.0531, cause.parameters[0].high = 0.0549;
    CHECK_THAT(cause_sentence(cause), Contains("= 54 mm (53.1 mm to 54.9 mm)."));
    CHECK(quantity(0.0123456, "m") == "12.35 mm");
    CHECK(quantity(0.0123456, "m", 1) == "12.346 mm");
}
