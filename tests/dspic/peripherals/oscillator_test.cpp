#include "emu/dspic/peripherals/timing/oscillator.h"

#include "tests/dspic/peripherals/peripheral_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

constexpr double kCrystal = 7'372'800.0;

struct OscillatorBench : Bench {
    Oscillator oscillator{around, clock, kCrystal};

    void start(std::uint16_t fosc) {
        oscillator.configure({.fosc = fosc});
        oscillator.reset(true);
    }
    void low(int value) { sfr.write(sfr::OSCCON, static_cast<std::uint16_t>(value), 0x00FF); }
    void high(int value) { sfr.write(sfr::OSCCON, static_cast<std::uint16_t>(value << 8), 0xFF00); }
    void unlock_low(int value) {
        for (const int byte : {0x46, 0x57, value}) {
            low(byte);
            ++now;
        }
    }
    void unlock_high(int value) {
        for (const int byte : {0x78, 0x9A, value}) {
            high(byte);
            ++now;
        }
    }
};

}  // namespace

TEST_CASE("FOSC words choose source and multiplier") {
    CHECK(decode_fosc(0xFFE6, kCrystal).hertz == kCrystal * 8);  // XT with PLL x8, the e-puck's
    CHECK(decode_fosc(0xC706, kCrystal).hertz == kCrystal * 8);
    CHECK(decode_fosc(0x0705, kCrystal).hertz == kCrystal * 4);
    CHECK(decode_fosc(0x0707, kCrystal).hertz == kCrystal * 16);
    CHECK(decode_fosc(0x0304, kCrystal).hertz == kCrystal);
    CHECK(decode_fosc(0x0712, kCrystal).hertz == kCrystal * 4);  // HS/2 x8
    CHECK(decode_fosc(0x0715, 9e6).hertz == 12e6);               // HS/3 x4
    CHECK(decode_fosc(0xB9E0, kCrystal).hertz == 7.37e6);        // FRC
    CHECK(decode_fosc(0x070A, kCrystal).hertz == 7.37e6 * 8);    // FRC x8
    CHECK(decode_fosc(0x0200, kCrystal).hertz == 512e3);         // LPRC
    CHECK(decode_fosc(0x0000, kCrystal).hertz == 32768.0);       // LP
}

TEST_CASE_METHOD(OscillatorBench, "OSCCON shows the source and opens only to its key sequence") {
    start(0xFFE6);
    CHECK(clock.hertz() == 14'745'600.0);
    CHECK(read(sfr::OSCCON) == 0x7720);  // COSC = NOSC = 7, locked
    high(0x01);
    CHECK(read(sfr::OSCCON) == 0x7720);
    write(sfr::OSCCON, 0x0100);
    CHECK(read(sfr::OSCCON) == 0x7720);
    unlock_high(0x01);
    CHECK(read(sfr::OSCCON) == 0x7120);
    high(0x78);
    now += 10;  // too late
    high(0x9A);
    ++now;
    high(0x02);
    CHECK(read(sfr::OSCCON) == 0x7120);
}

TEST_CASE_METHOD(OscillatorBench, "OSWEN switches the clock after its delay, if FCKSM allows it") {
    start(0x3F06);  // FCKSM = 00
    unlock_high(0x01);
    unlock_low(0x01);
    CHECK(read(sfr::OSCCON) == 0x7121);
    CHECK(clock.hertz() == 14'745'600.0);
    go(now + 20);
    CHECK(read(sfr::OSCCON) == 0x1100);
    CHECK(clock.hertz() == 7.37e6 / 4);
    unlock_high(0x07);
    unlock_low(0x01);
    go(now + 20);
    CHECK(read(sfr::OSCCON) == 0x1701);  // waits for the crystal: 1024 periods = 256 cycles here
    go(now + 300);
    CHECK(read(sfr::OSCCON) == 0x7720);

    start(0xFFE6);  // switching off
    unlock_high(0x01);
    unlock_low(0x01);
    CHECK(read(sfr::OSCCON) == 0x7120);
    go(now + 1000);
    CHECK(clock.hertz() == 14'745'600.0);
}

TEST_CASE_METHOD(OscillatorBench, "POST divides the instruction clock") {
    start(0xFFE6);
    double told = 0.0;
    oscillator.on_rate_owner = &told;
    oscillator.on_rate = [](void* owner, double hertz) { *static_cast<double*>(owner) = hertz; };
    unlock_low(0x80);
    CHECK(clock.hertz() == 14'745'600.0 / 16);
    CHECK(told == 14'745'600.0 / 16);
}
