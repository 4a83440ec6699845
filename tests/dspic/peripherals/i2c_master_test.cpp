#include "emu/dspic/peripherals/serial/i2c_master.h"

#include "tests/dspic/peripherals/peripheral_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop::dspic;
using namespace puckloop::dspic::test;
using puckloop::cosim::I2cPhase;
using puckloop::cosim::I2cPhaseKind;
using puckloop::cosim::Time;

namespace {

constexpr std::uint16_t kEnable = 0x8000;
constexpr std::uint16_t kSen = 1, kRsen = 2, kPen = 4, kRcen = 8, kAcken = 16, kAckdt = 32;
constexpr std::uint16_t kAckstat = 0x8000, kTrstat = 0x4000, kBcl = 0x400, kIwcol = 0x80, kP = 0x10, kS = 8,
                        kRbf = 2, kTbf = 1;
// FSCL = 1 / (151 / FCY + 1 / 1,111,111): 164.27 cycles, 89.8 kHz.
constexpr double kScl = 151.0 + 14'745'600.0 / 1'111'111.0;

struct I2cBench : Bench {
    Ports ports{around, layout_dspic30f6014a().ports, pins};
    I2cMaster i2c{around, layout_dspic30f6014a().i2cs[0], clock, ports, pins};

    I2cBench() {
        write(sfr::I2CBRG, 150);
        write(sfr::I2CCON, kEnable);
    }
    void set(std::uint16_t bits) { write(sfr::I2CCON, static_cast<std::uint16_t>(read(sfr::I2CCON) | bits)); }
    std::uint16_t stat() { return read(sfr::I2CSTAT); }
    Cycle done() { return until_flag(irq::MI2C, now + 100000); }
    /// The bus answers the last phase when its ninth clock ends.
    void answer(I2cPhaseKind kind, std::uint8_t byte, bool ack, Time stretch = 0) {
        const I2cPhase& last = pins.phases.back();
        go(clock.first_cycle_at(last.start + 9 * last.clock_period + stretch));
        i2c.answer({.kind = kind, .byte = byte, .ack = ack}, now);
    }
};

}  // namespace

TEST_CASE_METHOD(I2cBench, "a stop on the idle bus sets P, and P outlives I2CEN and a write of I2CSTAT") {
    CHECK((stat() & kP) == 0);
    set(kPen);
    CHECK(read(sfr::I2CCON) & kPen);
    done();
    CHECK_FALSE(read(sfr::I2CCON) & kPen);
    CHECK((stat() & (kP | kS)) == kP);
    CHECK(pins.phases.empty());  // nobody was addressed
    write(sfr::I2CCON, 0);
    write(sfr::I2CCON, kEnable);
    write(sfr::I2CSTAT, 0);
    CHECK((stat() & (kP | kS)) == kP);
}

TEST_CASE_METHOD(I2cBench, "a register read: start, address, register, restart, address, byte, nack, stop") {
    const Cycle begun = now;
    set(kSen);
    CHECK(done() == begun + 1 + 164);
    CHECK((stat() & (kP | kS)) == kS);

    write(sfr::I2CTRN, 0xC0);
    REQUIRE(pins.phases.size() == 1);
    CHECK(pins.phases[0].kind == I2cPhaseKind::Start);
    CHECK(pins.phases[0].byte == 0xC0);
    CHECK(std::abs(static_cast<double>(pins.phases[0].clock_period) - kScl / 14.7456e6 * 1e12) < 2.0);
    CHECK((stat() & (kTrstat | kTbf)) == (kTrstat | kTbf));
    CHECK(i2c.earliest(now) == kNoCycle);
    go(now + static_cast<Cycle>(8.1 * kScl));
    CHECK((stat() & (kTrstat | kTbf)) == kTrstat);
    CHECK_FALSE(flag(irq::MI2C));
    answer(I2cPhaseKind::Acknowledge, 0, true);
    CHECK(take(irq::MI2C));
    CHECK((stat() & (kTrstat | kTbf | kAckstat)) == 0);

    write(sfr::I2CTRN, 0x02);
    CHECK(pins.phases.back().kind == I2cPhaseKind::Write);
    answer(I2cPhaseKind::Acknowledge, 0, false);
    CHECK(take(irq::MI2C));
    CHECK(stat() & kAckstat);

    set(kRsen);
    done();
    write(sfr::I2CTRN, 0xC1);
    CHECK(pins.phases.back().kind == I2cPhaseKind::Start);
    answer(I2cPhaseKind::Acknowledge, 0, true);
    take(irq::MI2C);

    set(kRcen);
    CHECK(pins.phases.back().kind == I2cPhaseKind::Read);
    answer(I2cPhaseKind::Data, 0x5C, true);
    CHECK(take(irq::MI2C));
    CHECK_FALSE(read(sfr::I2CCON) & kRcen);
    CHECK(stat() & kRbf);
    CHECK(read(sfr::I2CRCV) == 0x5C);
    CHECK_FALSE(stat() & kRbf);

    set(kAckdt);
    set(kAcken);
    done();
    CHECK_FALSE(read(sfr::I2CCON) & kAcken);
    set(kPen);
    CHECK(pins.phases.back().kind == I2cPhaseKind::Stop);
    done();
    CHECK((stat() & (kP | kS)) == kP);
    CHECK(pins.phases.size() == 5);
}

TEST_CASE_METHOD(I2cBench, "a second request while one is active is ignored, writing I2CTRN sets IWCOL") {
    set(kSen);
    set(kPen);
    CHECK_FALSE(read(sfr::I2CCON) & kPen);
    write(sfr::I2CTRN, 1);
    CHECK(stat() & kIwcol);
    write(sfr::I2CSTAT, 0);
    CHECK_FALSE(stat() & kIwcol);
    done();
    CHECK(stat() & kS);
    CHECK(until_flag(irq::MI2C, 10000) == kNoCycle);
}

TEST_CASE_METHOD(I2cBench, "arbitration lost sets BCL and frees the module") {
    set(kSen);
    done();
    write(sfr::I2CTRN, 0x40);
    answer(I2cPhaseKind::BusLost, 0, false);
    CHECK(take(irq::MI2C));
    CHECK(stat() & kBcl);
    CHECK((stat() & kTrstat) == 0);
    write(sfr::I2CTRN, 0x40);  // without a start nobody hears it
    CHECK(pins.phases.size() == 1);
    done();
    CHECK(stat() & kAckstat);
}

// UM10204, 3.1.10: the byte that follows a START is the address. Nobody drives SDA in it: 0xFF, which is
// reserved (table 4). What is sent then is a data byte for nobody.
TEST_CASE_METHOD(I2cBench, "a byte received right behind a START is an address byte of ones on the wires") {
    set(kSen);
    done();
    set(kRcen);
    REQUIRE(pins.phases.size() == 1);
    CHECK(pins.phases[0].kind == I2cPhaseKind::Start);
    CHECK(pins.phases[0].byte == 0xFF);
    answer(I2cPhaseKind::Acknowledge, 0xFF, false);
    CHECK((stat() & kRbf) != 0);
    CHECK(read(sfr::I2CRCV) == 0xFF);
    write(sfr::I2CTRN, 0x40);
    CHECK(pins.phases.back().kind == I2cPhaseKind::Write);
}

TEST_CASE_METHOD(I2cBench, "switching off in mid transfer frees the bus once the answer came") {
    set(kSen);
    done();
    write(sfr::I2CTRN, 0x40);
    write(sfr::I2CCON, 0);
    CHECK(pins.phases.size() == 1);
    answer(I2cPhaseKind::Acknowledge, 0, true);
    REQUIRE(pins.phases.size() == 2);
    CHECK(pins.phases[1].kind == I2cPhaseKind::Stop);
    CHECK_FALSE(take(irq::MI2C));
}

TEST_CASE_METHOD(I2cBench, "what is asked for when the module is on again begins once the bus is free") {
    constexpr std::uint16_t kAsked[] = {kSen, kRsen, kPen, kRcen, kAcken};
    constexpr double kClocks[] = {1.0, 1.5, 1.5, 8.0, 0.125};
    for (std::size_t i = 0; i < std::size(kAsked); ++i) {
        CAPTURE(kAsked[i]);
        set(kSen);
        done();
        write(sfr::I2CTRN, 0x40);
        write(sfr::I2CCON, 0);
        write(sfr::I2CCON, kEnable);
        set(kAsked[i]);
        CHECK((read(sfr::I2CCON) & kAsked[i]) != 0);
        set(kPen);  // one at a time
        CHECK((read(sfr::I2CCON) & (kPen & ~kAsked[i])) == 0);
        const std::size_t sent = pins.phases.size();
        answer(I2cPhaseKind::Acknowledge, 0, true);
        REQUIRE(pins.phases.size() == sent + 1);
        CHECK(pins.phases.back().kind == I2cPhaseKind::Stop);
        const Cycle freed = now;
        const Cycle ended = done();
        CHECK(ended - freed == Approx(kClocks[i] * kScl).margin(2));
        CHECK((read(sfr::I2CCON) & kAsked[i]) == 0);
        write(sfr::I2CCON, 0);
        write(sfr::I2CCON, kEnable);
        read(sfr::I2CRCV);
    }
    // A byte without a START, likewise.
    set(kSen);
    done();
    write(sfr::I2CTRN, 0x40);
    write(sfr::I2CCON, 0);
    write(sfr::I2CCON, kEnable);
    write(sfr::I2CTRN, 0x55);
    CHECK((stat() & (kTrstat | kTbf | kIwcol)) == (kTrstat | kTbf));
    answer(I2cPhaseKind::Acknowledge, 0, true);
    done();
    CHECK((stat() & (kTrstat | kAckstat)) == kAckstat);
}

TEST_CASE_METHOD(I2cBench,
                 "the earliest next phase: a start condition away, or at once when the bus is owned") {
    CHECK(i2c.earliest(now) > now + 10);
    set(kSen);
    const Cycle started = i2c.earliest(now);
    CHECK(started == now + 1 + 164);
    done();
    CHECK(i2c.earliest(now) == now + 1);
}
