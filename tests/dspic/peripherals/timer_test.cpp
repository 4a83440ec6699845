#include "emu/dspic/peripherals/timing/timer.h"

#include "tests/dspic/peripherals/peripheral_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

constexpr std::uint16_t kOn = 0x8000;
constexpr std::uint16_t kBy8 = 0x0010;
constexpr std::uint16_t kBy256 = 0x0030;
constexpr std::uint16_t kExternal = 0x0002;
constexpr std::uint16_t kGate = 0x0040;
constexpr std::uint16_t k32Bit = 0x0008;

struct TimerBench : Bench {
    Timer t3{around, {sfr::TMR3, sfr::PR3, sfr::T3CON, irq::T3}};
    Timer t2{around, {sfr::TMR2, sfr::PR2, sfr::T2CON, irq::T2, sfr::TMR3HLD}, &t3};
    Timer t1{around, {sfr::TMR1, sfr::PR1, sfr::T1CON, irq::T1}};
};

}  // namespace

TEST_CASE_METHOD(TimerBench, "a timer interrupts every PR + 1 counts and its count is computed") {
    write(sfr::PR2, 1474);
    go(10);
    write(sfr::T2CON, kOn);  // counts from cycle 11 on
    go(11 + 100);
    CHECK(read(sfr::TMR2) == 100);
    CHECK(until_flag(irq::T2, 100000) == 11 + 1475);
    CHECK(read(sfr::TMR2) == 0);
    CHECK(until_flag(irq::T2, 100000) == 11 + 2 * 1475);
    CHECK(until_flag(irq::T2, 100000) == 11 + 3 * 1475);
    write(sfr::T2CON, 0);
    const std::uint16_t held = read(sfr::TMR2);
    go(now + 5000);
    CHECK(read(sfr::TMR2) == held);
    CHECK_FALSE(flag(irq::T2));
}

TEST_CASE_METHOD(TimerBench, "prescalers divide, and a write to TMR restarts them") {
    write(sfr::PR1, 184);
    write(sfr::T1CON, kOn | kBy8);  // from cycle 1
    CHECK(until_flag(irq::T1, 100000) == 1 + 1480);
    go(1 + 1480 + 7);
    CHECK(read(sfr::TMR1) == 0);
    go(1 + 1480 + 8);
    CHECK(read(sfr::TMR1) == 1);
    go(1 + 1480 + 13);
    write(sfr::TMR1, 180);  // five counts to go, from a cleared prescaler
    CHECK(until_flag(irq::T1, 100000) == 1 + 1480 + 14 + 5 * 8);
    write(sfr::T1CON, kOn | kBy256);
    write(sfr::TMR1, 0);
    const Cycle start = now + 1;
    CHECK(until_flag(irq::T1, 100000) == start + 185 * 256);
}

TEST_CASE_METHOD(TimerBench, "PR = 0 never interrupts, a count beyond PR goes round through 0xFFFF") {
    write(sfr::PR1, 0);
    write(sfr::T1CON, kOn);
    CHECK(until_flag(irq::T1, 200000) == kNoCycle);
    write(sfr::PR1, 99);
    write(sfr::TMR1, 200);
    const Cycle start = now + 1;
    go(start + 1000);
    CHECK(read(sfr::TMR1) == 1200);
    CHECK(until_flag(irq::T1, start + 200000) == start + (65536 - 200) + 100);
}

TEST_CASE_METHOD(TimerBench,
                 "an external clock counts rising edges and interrupts when the count reaches PR") {
    write(sfr::PR1, 5);
    write(sfr::TMR1, 4);
    write(sfr::T1CON, kOn | kExternal);
    t1.clock_pin(true, 100);
    CHECK(take(irq::T1));
    CHECK(read(sfr::TMR1) == 5);
    t1.clock_pin(false, 200);
    t1.clock_pin(true, 300);
    CHECK_FALSE(take(irq::T1));
    CHECK(read(sfr::TMR1) == 0);
    for (int i = 0; i < 5; ++i) {
        t1.clock_pin(false, 400);
        t1.clock_pin(true, 500);
    }
    CHECK(take(irq::T1));
}

TEST_CASE_METHOD(TimerBench, "a gated timer counts while the pin is high and interrupts at its fall") {
    write(sfr::T1CON, kOn | kGate);
    go(100);
    CHECK(read(sfr::TMR1) == 0);
    t1.clock_pin(true, 100);
    go(350);
    CHECK(read(sfr::TMR1) == 250);
    t1.clock_pin(false, 400);
    CHECK(take(irq::T1));
    go(1000);
    CHECK(read(sfr::TMR1) == 300);
}

TEST_CASE_METHOD(TimerBench, "Timer2 and 3 pair to 32 bits with Timer3's flag and the holding register") {
    write(sfr::PR2, 0x0001);
    write(sfr::PR3, 0x0001);  // period 0x10002 counts
    write(sfr::TMR3HLD, 0);
    write(sfr::T2CON, kOn | k32Bit);  // from cycle ... now + 1
    const Cycle start = now + 1;
    go(start + 0x10000);
    CHECK(read(sfr::TMR2) == 0x0000);
    CHECK(read(sfr::TMR3HLD) == 0x0001);
    CHECK(until_flag(irq::T3, start + 0x30000) == start + 0x10002);
    CHECK_FALSE(flag(irq::T2));
    write(sfr::TMR3HLD, 0x0001);
    write(sfr::TMR2, 0x0000);
    const Cycle again = now + 1;
    CHECK(until_flag(irq::T3, again + 0x30000) == again + 2);
}

TEST_CASE_METHOD(TimerBench, "each match calls the trigger, 16 and 32 bits alike") {
    int matches = 0;
    t3.on_match_owner = &matches;
    t3.on_match = [](void* owner, Cycle) { ++*static_cast<int*>(owner); };
    write(sfr::PR3, 9);
    write(sfr::T3CON, kOn);
    go(now + 1 + 100);
    CHECK(matches == 10);
    write(sfr::T3CON, 0);
    write(sfr::PR2, 9);
    write(sfr::PR3, 0);
    write(sfr::TMR3, 0);
    write(sfr::T2CON, kOn | k32Bit);
    go(now + 1 + 100);
    CHECK(matches == 20);
}
