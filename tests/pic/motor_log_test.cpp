#include "emu/pic/motor_log.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using cosim::kMillisecond;
using pic::MotorLog;

TEST_CASE("a motor's log has starts, turns and stops, not steps") {
    MotorLog motor("left");
    CHECK_FALSE(motor.still(cosim::kSecond));
    auto line = motor.step(1, cosim::kSecond);
    REQUIRE(line);
    CHECK(line->second == "left motor runs forward from step 0");
    CHECK_FALSE(motor.step(2, cosim::kSecond + 10 * kMillisecond));
    line = motor.step(1, cosim::kSecond + 20 * kMillisecond);
    REQUIRE(line);
    CHECK(line->second == "left motor runs back from step 2");
    CHECK_FALSE(motor.still(cosim::kSecond + 270 * kMillisecond));
    line = motor.still(cosim::kSecond + 271 * kMillisecond);
    REQUIRE(line);
    CHECK(line->first == cosim::kSecond + 270 * kMillisecond);
    CHECK(line->second == "left motor still since 1.020000 s, at step 1");
    CHECK_FALSE(motor.still(3 * cosim::kSecond));
    CHECK(motor.step(0, 3 * cosim::kSecond));
}
