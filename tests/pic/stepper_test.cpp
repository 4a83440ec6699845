#include "emu/pic/stepper.h"

#include <catch2/catch.hpp>

#include <array>

using namespace puckloop;
using pic::StepperDecoder;
using pic::StepSense;

namespace {

constexpr dspic::Cycle kSettle = 30;
constexpr std::array<std::uint8_t, 4> kTable{0b1010, 0b0110, 0b0101, 0b1001};

/// Writes the bits of `to` one after the other, `gap` cycles apart, as the firmware does.
dspic::Cycle write_bits(StepperDecoder& motor, std::uint8_t to, dspic::Cycle now, dspic::Cycle gap) {
    std::uint8_t level = motor.pattern();
    for (int bit = 0; bit < 4; ++bit) {
        level = static_cast<std::uint8_t>((level & ~(1 << bit)) | (to & (1 << bit)));
        motor.coils(level, now += gap);
    }
    return now;
}

}  // namespace

TEST_CASE("forward is backwards through the table on the left, forwards on the right") {
    StepperDecoder left(StepSense::LeftMotor, kSettle), right(StepSense::RightMotor, kSettle);
    dspic::Cycle now = 0;
    for (int i = 1; i <= 1000; ++i) {
        now += 29440;
        left.coils(kTable[static_cast<std::size_t>((4000 - i) % 4)], now);
        right.coils(kTable[static_cast<std::size_t>(i % 4)], now);
    }
    now += kSettle;
    left.settle(now);
    right.settle(now);
    CHECK(left.steps() == 1000);
    CHECK(right.steps() == 1000);
    CHECK(left.illegal_patterns() == 0);
    CHECK(left.phase_jumps() == 0);
}

TEST_CASE("patterns on the way from one phase to the next are not steps") {
    for (int direction : {1, -1}) {
        StepperDecoder motor(StepSense::RightMotor, kSettle);
        dspic::Cycle now = 0;
        int phase = 0;
        for (int i = 0; i < 40; ++i) {
            phase = (phase + direction + 4) % 4;
            now = write_bits(motor, kTable[static_cast<std::size_t>(phase)], now + 10000, 6);
        }
        motor.settle(now + kSettle);
        CHECK(motor.steps() == 40 * direction);
        CHECK(motor.illegal_patterns() == 0);
    }
}

TEST_CASE("a step is due when its pattern has stood for the settle time, not before") {
    StepperDecoder motor(StepSense::RightMotor, kSettle);
    motor.coils(kTable[1], 100);
    CHECK(motor.due() == 130);
    CHECK_FALSE(motor.settle(129));
    CHECK(motor.steps() == 0);
    CHECK(motor.settle(130));
    CHECK(motor.steps() == 1);
    CHECK(motor.due() == dspic::kNoCycle);
}

TEST_CASE("a pattern that stands for less than the settle time is ignored") {
    StepperDecoder motor(StepSense::RightMotor, kSettle);
    motor.coils(kTable[1], 100);
    motor.coils(kTable[0], 129);
    CHECK_FALSE(motor.settle(1000));
    CHECK(motor.steps() == 0);
}

TEST_CASE("coils off keep the rotor where it is") {
    StepperDecoder motor(StepSense::RightMotor, kSettle);
    motor.coils(kTable[1], 100);
    motor.coils(0, 1000);
    CHECK(motor.steps() == 1);
    CHECK(motor.due() == dspic::kNoCycle);
    motor.coils(kTable[1], 2000);  // the same phase again: no step
    motor.coils(kTable[2], 3000);
    motor.settle(4000);
    CHECK(motor.steps() == 2);
    motor.coils(0, 5000);
    motor.coils(kTable[1], 6000);  // back from off: one step back
    motor.settle(7000);
    CHECK(motor.steps() == 1);
}

TEST_CASE("illegal patterns and jumps of two phases move nothing and are counted") {
    StepperDecoder motor(StepSense::RightMotor, kSettle);
    motor.coils(0b1111, 100);
    motor.coils(0b0001, 1000);
    motor.coils(kTable[2], 2000);  // two away from 0
    motor.settle(3000);
    CHECK(motor.steps() == 0);
    CHECK(motor.illegal_patterns() == 2);
    CHECK(motor.phase_jumps() == 1);
    motor.coils(kTable[3], 4000);
    motor.settle(5000);
    CHECK(motor.steps() == 1);
}
