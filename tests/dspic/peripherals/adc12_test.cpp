#include "emu/dspic/peripherals/adc12.h"

#include "tests/dspic/peripherals/peripheral_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

constexpr std::uint16_t kSamp = 2, kDone = 1, kAsam = 4, kAdon = 0x8000;
constexpr std::uint16_t kCounter = 7 << 5, kTimer3 = 2 << 5, kInt0 = 1 << 5;
constexpr std::uint16_t kCscna = 0x0400, kBufs = 0x80, kBufm = 2, kAlts = 1;

struct AdcBench : Bench {
    Adc12 adc{around, clock, pins};

    AdcBench() {
        for (int i = 0; i < 16; ++i)
            pins.volts[static_cast<std::size_t>(i)] = (100.5 + 200 * i) / 4096.0;
    }
    static std::uint16_t counts(int channel) { return static_cast<std::uint16_t>(100 + 200 * channel); }
    static std::uint16_t smpi(int conversions) { return static_cast<std::uint16_t>((conversions - 1) << 2); }
};

}  // namespace

TEST_CASE_METHOD(AdcBench,
                 "the robot's scan: AN8 to AN15 in 1200 cycles, each input taken at its own instant") {
    write(sfr::ADCON2, 0x041C);
    write(sfr::ADCON3, 0x0113);  // TAD = 10 cycles, SAMC = 1
    write(sfr::ADPCFG, 0x0003);
    write(sfr::ADCSSL, 0xFF00);
    go(99);
    write(sfr::ADCON1, 0x80E4);  // sampling begins in cycle 100
    CHECK(until_flag(irq::ADC, 100000) == 100 + 1200);
    CHECK(until_flag(irq::ADC, 100000) == 100 + 2400);
    for (int i = 0; i < 8; ++i) {
        CHECK(read(static_cast<std::uint16_t>(sfr::ADCBUF0 + 2 * i)) == counts(8 + i));
        CHECK(pins.samples[static_cast<std::size_t>(i)].channel == 8 + i);
        CHECK(pins.samples[static_cast<std::size_t>(i)].at == 100u + 150u * static_cast<unsigned>(i) + 10u);
    }
}

TEST_CASE_METHOD(AdcBench, "results of a running scan appear exactly when their conversion ends") {
    write(sfr::ADCON2, 0x041C);
    write(sfr::ADCON3, 0x0113);
    write(sfr::ADCSSL, 0xFF00);
    write(sfr::ADCON1, 0x80E4);  // from cycle 1
    go(1 + 150 - 1);
    CHECK(read(sfr::ADCBUF0) == 0);
    CHECK_FALSE(read(sfr::ADCON1) & kDone);
    CHECK_FALSE(read(sfr::ADCON1) & kSamp);
    go(1 + 150);
    CHECK(read(sfr::ADCBUF0) == counts(8));
    CHECK(read(sfr::ADCON1) & kDone);
    CHECK(read(sfr::ADCON1) & kSamp);
    go(1 + 160);
    CHECK_FALSE(read(sfr::ADCON1) & kDone);
}

TEST_CASE_METHOD(AdcBench, "a scan of more inputs than SMPI + 1 never reaches the upper ones") {
    write(sfr::ADCON2, kCscna | smpi(2));
    write(sfr::ADCON3, 0x0100);
    write(sfr::ADCSSL, 0x001C);
    write(sfr::ADCON1, kAdon | kCounter | kAsam);
    until_flag(irq::ADC, 10000);
    until_flag(irq::ADC, 10000);
    CHECK(read(sfr::ADCBUF0) == counts(2));
    CHECK(read(sfr::ADCBUF0 + 2) == counts(3));
    CHECK(read(sfr::ADCBUF0 + 4) == 0);
}

TEST_CASE_METHOD(AdcBench, "software samples and converts a single input, TAD counts half cycles") {
    write(sfr::ADCHS, 5);
    write(sfr::ADCON3, 0x0002);  // TAD = 1.5 cycles
    write(sfr::ADCON1, kAdon);
    write(sfr::ADCON1, kAdon | kSamp);
    go(500);
    CHECK(read(sfr::ADCON1) == (kAdon | kSamp));
    write(sfr::ADCON1, kAdon);  // converts from cycle 501 on: 21 cycles
    CHECK(until_flag(irq::ADC, 10000) == 501 + 21);
    CHECK(read(sfr::ADCON1) == (kAdon | kDone));
    CHECK(read(sfr::ADCBUF0) == counts(5));
    REQUIRE(pins.samples.size() == 1);
    CHECK(pins.samples[0].at == 501);
    CHECK(until_flag(irq::ADC, 100000) == kNoCycle);
}

TEST_CASE_METHOD(AdcBench, "SAMP with the internal counter converts once, DONE can be cleared but not set") {
    write(sfr::ADCHS, 1);
    write(sfr::ADCON3, 0x0201);  // TAD 1 cycle, SAMC 2
    write(sfr::ADCON1, kAdon | kCounter);
    write(sfr::ADCON1, kAdon | kCounter | kSamp);
    CHECK(until_flag(irq::ADC, 10000) == 1 + 2 + 14);
    CHECK(read(sfr::ADCON1) & kDone);
    write(sfr::ADCON1, kAdon | kCounter);
    CHECK_FALSE(read(sfr::ADCON1) & kDone);
    write(sfr::ADCON1, kAdon | kCounter | kDone);
    CHECK_FALSE(read(sfr::ADCON1) & kDone);
}

TEST_CASE_METHOD(AdcBench, "Timer3 and INT0 end sampling when SSRC selects them") {
    write(sfr::ADCON3, 0x0001);
    write(sfr::ADCON1, kAdon | kTimer3 | kAsam);
    go(700);
    adc.trigger(Adc12::Trigger::Int0, now);
    adc.trigger(Adc12::Trigger::Timer3, now);
    CHECK(until_flag(irq::ADC, 10000) == 714);
    write(sfr::ADCON1, kAdon | kInt0 | kAsam);
    adc.trigger(Adc12::Trigger::Timer3, 800);
    CHECK(until_flag(irq::ADC, 10000) == kNoCycle);
    go(900);
    adc.trigger(Adc12::Trigger::Int0, now);
    CHECK(until_flag(irq::ADC, 10000) == 914);
}

TEST_CASE_METHOD(AdcBench, "BUFM fills halves in turn, ALTS takes MUX A and B in turn") {
    write(sfr::ADCHS, 0x0703);  // B: AN7, A: AN3
    write(sfr::ADCON2, smpi(2) | kBufm | kAlts);
    write(sfr::ADCON3, 0x0100);
    write(sfr::ADCON1, kAdon | kCounter | kAsam);
    until_flag(irq::ADC, 10000);
    CHECK(read(sfr::ADCON2) & kBufs);
    CHECK(read(sfr::ADCBUF0) == counts(3));
    CHECK(read(sfr::ADCBUF0 + 2) == counts(7));
    CHECK(read(sfr::ADCBUF8) == 0);
    until_flag(irq::ADC, 10000);
    CHECK_FALSE(read(sfr::ADCON2) & kBufs);
    CHECK(read(sfr::ADCBUF8) == counts(3));
    CHECK(read(sfr::ADCBUF9) == counts(7));
}

TEST_CASE_METHOD(AdcBench, "FORM, clipping and digital pins") {
    const auto one = [&](int form, double volts) {
        pins.volts[0] = volts;
        write(sfr::ADCON1, 0);
        write(sfr::ADCON1, static_cast<std::uint16_t>(kAdon | form << 8 | kSamp));
        write(sfr::ADCON1, static_cast<std::uint16_t>(kAdon | form << 8));
        until_flag(irq::ADC, now + 1000);
        return read(sfr::ADCBUF0);
    };
    CHECK(one(0, 0.5) == 2048);
    CHECK(one(0, 1.5) == 4095);
    CHECK(one(0, -0.5) == 0);
    CHECK(one(1, 0.5) == 0);
    CHECK(one(1, 0.0) == 0xF800);
    CHECK(one(2, 0.75) == 0xC000);
    CHECK(one(3, 0.25) == 0xC000);
    write(sfr::ADPCFG, 1);
    CHECK(one(0, 0.75) == 0);
}

TEST_CASE_METHOD(AdcBench, "ADON = 0 aborts, and a new start fills from ADCBUF0 and the lowest input") {
    write(sfr::ADCON2, kCscna | smpi(4));
    write(sfr::ADCON3, 0x0113);
    write(sfr::ADCSSL, 0x00F0);
    write(sfr::ADCON1, kAdon | kCounter | kAsam);
    go(400);
    write(sfr::ADCON1, kCounter | kAsam);
    CHECK(until_flag(irq::ADC, 100000) == kNoCycle);
    go(1000);
    pins.volts[4] = 0.5;
    write(sfr::ADCON1, kAdon | kCounter | kAsam);
    CHECK(until_flag(irq::ADC, 100000) == 1001 + 600);
    CHECK(read(sfr::ADCBUF0) == 2048);
}
