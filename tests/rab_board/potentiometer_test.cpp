#include "emu/rab_board/potentiometer.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using cosim::kMillisecond;
using rab::Potentiometer;

TEST_CASE("the potentiometer takes a byte over when its select line rises, and then settles") {
    Potentiometer pot(128);
    pot.select(false, 0);
    pot.shift(0x64, 8);
    CHECK(pot.due() == cosim::kNever);
    pot.select(true, 30);
    CHECK(pot.wiper() == 128);
    CHECK(pot.due() == 30 + rab::kPotentiometerSettling);
    CHECK(pot.settle() == 0x64);
    CHECK(pot.wiper() == 0x64);
    CHECK(pot.due() == cosim::kNever);
    CHECK(pot.bytes() == 1);
}

TEST_CASE("bits that come while it is not selected, or no bits at all, change nothing") {
    Potentiometer pot(128);
    pot.shift(0x11, 8);
    pot.select(false, 0);
    pot.select(true, 10);
    CHECK(pot.due() == cosim::kNever);
    CHECK(pot.bytes() == 0);
}

TEST_CASE("of more than eight bits the last eight stay, and a later byte starts settling anew") {
    Potentiometer pot(128);
    pot.select(false, 0);
    pot.shift(0x11, 8);
    pot.shift(0x22, 8);
    pot.select(true, 10);
    pot.select(false, 20);
    pot.shift(0x3344, 16);
    pot.select(true, 40);
    CHECK(pot.due() == 40 + rab::kPotentiometerSettling);
    CHECK(pot.settle() == 0x44);
}
