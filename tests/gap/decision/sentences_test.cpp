// The verdict in words.

#include "gap/next_experiment/suggest.h"
#include "gap/pipeline/describe.h"
#include "gap/verdict/sentences.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace puckloop::gap;
using Catch::Matchers::Contains;

TEST_CASE("a narrow interval is given with digits enough to see its ends") {
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

TEST_CASE("shares are in per cent, logarithms factors, and pure numbers have no unit") {
    CHECK(quantity(0.031, kShare) == "3.1 %");
    CHECK(quantity(0.62, kShare) == "62 %");
    CHECK(quantity(1.05, "1") == "1.05");
    CHECK(quantity(0.05, "ln counts") == "a factor of 1.051");
    CHECK(quantity(0.4962, "1/kg") == "0.4962 per kg");
    CHECK(change(0.0123, "m") == "+12.3 mm");
    CHECK(change(-0.0123, "m") == "-12.3 mm");
    CHECK(change(0.000321, kShare) == "+0.032 %");
    CHECK(change(-0.05, "ln counts") == "a factor of 0.951");
}

TEST_CASE("a cause of scatter claims what it gains, not an error that stays") {
    Held held{1, 1, 1.0, 0.99, 1.01, -1.2, -0.9, 0.25, 0.35, 10, 9, true, ""};
    CHECK(gain_sentence(held) ==
          "Gain on data that was not fitted: what readings are likely is predicted better, log score "
          "+0.3 a row, better in 9 of 10 blocks (90 % interval +0.25 to +0.35); errors are not "
          "smaller for sure: held-out error 100 % of what it was (90 % interval 99 to 101 %).");
    held.ratio = 0.5, held.low = 0.4, held.high = 0.6;
    CHECK(gain_sentence(held) == "Gain on data that was not fitted: held-out error 50 % of what it was (90 % "
                                 "interval 40 to 60 %), log "
                                 "score +0.3 a row, better in 9 of 10 blocks.");
}

TEST_CASE("where nothing was added no figures of no change are given") {
    CHECK(gain_sentence({1, 1, 1, 1, 1, -2, -2, 0, 0, 6, 0, false, ""}) ==
          "No gain is claimed: nothing was added to the simulator.");
    CHECK_THAT(gain_sentence({1, 1, 1.01, 0.9, 1.1, -2, -2.1, 0, 0, 6, 2, false, ""}),
               Contains("No gain is claimed: held-out error 101 %"));
    CHECK(plain_remark("needs a|b|c to vary") == "needs a or b or c to vary");
}

TEST_CASE("experiments that separate nothing or the same are not offered, equal ones share a rank") {
    const auto list =
        ranked({{"again", 3.0}, {"with motors on", 3.01}, {"far", 40.0}, {"near", 50.0}, {"other", 1e-5}});
    REQUIRE(list.size() == 3);
    CHECK(list[0].what == "near");  // both are sure to tell: more nats first, but one rank
    CHECK(list[1].what == "far");
    CHECK((list[0].rank == 1 && list[1].rank == 1));
    CHECK(list[2].what == "again");  // motors change nothing that the rivals disagree about
    CHECK(list[2].rank == 3);
    CHECK(ranked({{"nothing", 0.0}, {"either", 1e-6}}).empty());
}

TEST_CASE("where nothing separates rivals the catalogue's advice is called that") {
    Verdict verdict;
    verdict.decision = Decision::CannotTell;
    verdict.suggestions = {{"turn the robot", NAN, {}}};
    CHECK_THAT(summary_of(verdict), Contains("looked at would; the catalogue's advice is: turn the robot."));
    verdict.suggestions = {{"turn the robot", 0.7, {}}};
    CHECK_THAT(summary_of(verdict), Contains("This experiment would: turn the robot."));
}

TEST_CASE("sums and frames of a drive have plain names") {
    CHECK(plain_observable("along") == "distance along the heading");
    CHECK(plain_observable("outliers of x_m") == "outliers of position x");
    CHECK(plain_observable("reading") == "reading");
}

TEST_CASE("a set that ends further below the one it holds than its parameters cost was not fitted") {
    CHECK_FALSE(fit_failed(100, 2, 10000));
    CHECK_FALSE(fit_failed(-18.4, 2, 10000));
    CHECK(fit_failed(-2000, 2, 10000));
    CHECK(fit_failed(-INFINITY, 2, 10000));
}
