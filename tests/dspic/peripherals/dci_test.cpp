// The data converter interface to the cycle: frames, slots, buffers and their shadows, status, interrupts;
// and the low-voltage detector.

#include "emu/dspic/devices/dspic33fj256gp710_irq.h"
#include "emu/dspic/devices/dspic33fj256gp710_sfr.h"
#include "emu/dspic/peripherals/low_voltage.h"
#include "emu/dspic/peripherals/serial/dci.h"

#include "tests/dspic/peripherals/peripheral_bench.h"

#include <catch2/catch.hpp>

#include <random>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

constexpr std::uint16_t kEnable = 0x8000, kLoop = 0x0800, kSlaveClock = 0x0400, kUnfm = 0x0080,
                        kDjst = 0x0020;
constexpr std::uint16_t kTmpty = 1, kTunf = 2, kRful = 4, kRov = 8;

/// A codec that keeps what it is sent and answers by slot.
struct CodecPins : FakePins {
    std::uint16_t dci_exchange(const DciWord& word, Cycle now) override {
        words.push_back(word);
        times.push_back(now);
        return static_cast<std::uint16_t>(0x1110 * (word.slot + 1) + static_cast<int>(words.size()));
    }
    double supply() const override { return volts_at_vdd; }
    std::vector<DciWord> words;
    std::vector<Cycle> times;
    double volts_at_vdd = 3.3;
};

struct DciBench : Bench {
    CodecPins codec;
    Ports ports{around, layout_dspic30f6014a().ports, codec};
    Dci dci{around, layout_dspic30f6014a().dci, clock, ports, codec};

    std::uint16_t stat() { return read(sfr::DCISTAT); }
    void setup(unsigned words, unsigned bits, unsigned buffers, std::uint16_t slots, unsigned bcg) {
        write(sfr::DCICON2, static_cast<std::uint16_t>((buffers - 1) << 10 | (words - 1) << 5 | (bits - 1)));
        write(sfr::TSCON, slots);
        write(sfr::RSCON, slots);
        write(sfr::DCICON3, static_cast<std::uint16_t>(bcg));
    }
    void fill(std::uint16_t first) {
        for (int i = 0; i < 4; ++i)
            write(static_cast<std::uint16_t>(sfr::TXBUF0 + 2 * i), static_cast<std::uint16_t>(first + i));
    }
};

}  // namespace

TEST_CASE("a frame of eight 16-bit words at FCY/8 takes 1024 cycles, as the e-puck's codec wants it",
          "[dci]") {
    DciBench b;
    b.setup(8, 16, 2, 1, 3);
    b.fill(0x7FF0);
    CHECK((b.stat() & kTmpty) == 0);
    b.write(sfr::DCICON1, kEnable);
    CHECK((b.stat() & kTmpty) != 0);  // in their shadows
    CHECK_FALSE(b.flag(irq::DCI));
    // The frame sync begins one cycle after the write, data one bit (8 cycles) later; a word takes 128.
    b.go(1 + 8 + 128);
    REQUIRE(b.codec.words.size() == 1);
    CHECK(b.codec.times[0] == 137);
    CHECK(b.codec.words[0].value == 0x7FF0);
    CHECK(b.codec.words[0].bit_cycles == 8);
    CHECK(b.until_flag(irq::DCI, 5000) == 137 + 1024);  // the second word ends the buffer
    CHECK(b.codec.words[1].value == 0x7FF1);
    CHECK(b.read(sfr::RXBUF0) == 0x1111);
    CHECK((b.stat() & kRful) != 0);
    CHECK(b.read(sfr::RXBUF1) == 0x1112);
    CHECK((b.stat() & (kRful | kRov)) == 0);
    CHECK(b.until_flag(irq::DCI, 9000) == 137 + 3 * 1024);
    CHECK((b.stat() & kTunf) != 0);  // nobody had written TXBUF again
    CHECK(b.codec.words[2].value == 0);
}

TEST_CASE("SLOT is the slot under way, and 0 between DCIEN and the first", "[dci]") {
    DciBench b;
    b.setup(4, 10, 1, 1, 4);  // bit 10 cycles, word 100, frame 400
    b.write(sfr::DCICON1, kEnable | kDjst);
    for (Cycle at = 1; at < 1300; at += 7) {
        b.go(at);
        CHECK((b.stat() >> 8) == (at - 1) / 100 % 4);
    }
}

TEST_CASE("what is not written in time is zero, or the last word with UNFM, what is not read is lost",
          "[dci]") {
    for (const bool repeats : {false, true}) {
        DciBench b;
        b.setup(1, 16, 2, 1, 1);  // a word every 64 cycles
        b.fill(0x1000);
        b.write(sfr::DCICON1, static_cast<std::uint16_t>(kEnable | kDjst | (repeats ? kUnfm : 0)));
        b.write(sfr::TXBUF0, 0x2000);  // TXBUF1 is not
        b.go(1 + 4 * 64);
        REQUIRE(b.codec.words.size() == 4);
        CHECK(b.codec.words[2].value == 0x2000);
        CHECK(b.codec.words[3].value == (repeats ? 0x1001 : 0));
        CHECK((b.stat() & kTunf) != 0);
        CHECK((b.stat() & kRov) != 0);
        b.write(sfr::TXBUF0, 1);
        CHECK((b.stat() & kTunf) != 0);
        b.write(sfr::TXBUF1, 1);
        CHECK((b.stat() & (kTunf | kTmpty)) == 0);
        b.read(sfr::RXBUF0);
        CHECK((b.stat() & kRov) != 0);
        b.read(sfr::RXBUF1);
        CHECK((b.stat() & (kRov | kRful)) == 0);
    }
}

TEST_CASE("each enabled slot takes the next buffer, whatever the frame", "[dci]") {
    std::mt19937 engine(20);
    const auto random = [&] { return static_cast<unsigned>(engine()); };
    for (int round = 0; round < 60; ++round) {
        DciBench b;
        const unsigned words = 1 + random() % 16, bits = 4 + random() % 13, buffers = 1 + random() % 4;
        const auto slots = static_cast<std::uint16_t>((random() & 0xFFFF) | 1);
        const unsigned bcg = 1 + random() % 5;
        b.setup(words, bits, buffers, slots, bcg);
        b.fill(static_cast<std::uint16_t>(random()));
        b.write(sfr::DCICON1, kEnable | kLoop | kDjst);
        const Cycle word = Cycle{2} * (bcg + 1) * bits;
        const auto mask = static_cast<std::uint16_t>(0xFFFF << (16 - bits));
        Cycle frame = 1;
        unsigned buffer = 0;
        std::array<std::uint16_t, 4> sent{}, pending{};
        for (unsigned i = 0; i < 4; ++i)
            sent[i] = b.read(static_cast<std::uint16_t>(sfr::TXBUF0 + 2 * i));
        for (int frames = 0; frames < 4; ++frames, frame += words * word)
            for (unsigned slot = 0; slot < words; ++slot) {
                if (!(slots >> slot & 1)) continue;
                b.go(frame + (slot + 1) * word - 1);
                const std::size_t before = b.codec.words.size();
                b.go(b.now + 1);
                REQUIRE(b.codec.words.size() == before + 1);
                CHECK(b.codec.words.back().slot == slot);
                CHECK(b.codec.words.back().value == (sent[buffer] & mask));
                const bool last = ++buffer == buffers;
                CHECK(b.take(irq::DCI) == last);
                if (!last) continue;
                buffer = 0;
                for (unsigned i = 0; i < buffers; ++i)
                    CHECK(b.read(static_cast<std::uint16_t>(sfr::RXBUF0 + 2 * i)) == (sent[i] & mask));
                sent = pending;  // zeros where nobody wrote
                pending = {};
                if (frames % 2 == 0) continue;
                const auto first = static_cast<std::uint16_t>(random());
                b.fill(first);
                for (unsigned i = 0; i < 4; ++i)
                    pending[i] = static_cast<std::uint16_t>(first + i);
            }
    }
}

TEST_CASE("I2S starts slot 0 at both edges, AC-Link has a slot of 16 bits and twelve of 20", "[dci]") {
    DciBench i2s;
    i2s.setup(2, 16, 4, 1, 1);
    i2s.write(sfr::DCICON1, kEnable | 1);
    CHECK(i2s.until_flag(irq::DCI, 9000) == 1 + 4 + 3 * 2 * 64 + 64);

    DciBench link;
    link.setup(3, 8, 1, 0x1002, 1);  // WS and COFSG do not count
    link.write(sfr::DCICON1, kEnable | kDjst | 2);
    CHECK(link.until_flag(irq::DCI, 9000) == 1 + 16 * 4 + 20 * 4);
    CHECK(link.until_flag(irq::DCI, 9000) == 1 + 256 * 4);
    CHECK(link.codec.words.back().slot == 12);
    CHECK(link.codec.words.back().bits == 16);

    DciBench whole;
    whole.setup(3, 8, 1, 0x8000, 1);
    whole.write(sfr::DCICON1, kEnable | kDjst | 3);
    CHECK(whole.until_flag(irq::DCI, 9000) == 1 + 256 * 4);
    CHECK(whole.codec.words.back().slot == 15);
}

TEST_CASE("without a clock of its own nothing moves, disabled it stops, asleep it stands still", "[dci]") {
    DciBench b;
    b.setup(1, 16, 1, 1, 1);
    b.write(sfr::DCICON1, kEnable | kSlaveClock);
    b.go(10000);
    CHECK(b.codec.words.empty());
    b.write(sfr::DCICON1, 0);
    b.write(sfr::DCICON1, kEnable | kDjst);
    CHECK(b.until_flag(irq::DCI, 20000) == 10001 + 64);
    b.dci.hold(true);
    b.go(15000);
    CHECK(b.codec.words.size() == 1);
    b.dci.hold(false);
    CHECK(b.until_flag(irq::DCI, 20000) == 15000 + 64);
    b.write(sfr::DCICON1, 0);
    CHECK(b.stat() == 0);
    b.go(30000);
    CHECK(b.codec.words.size() == 2);
}

TEST_CASE("its four pins leave the port while it is on", "[dci]") {
    DciBench b;
    b.write(sfr::LATG, 0xF000);
    b.write(sfr::TRISG, 0x0FFF);
    b.setup(1, 16, 1, 1, 1);
    b.write(sfr::DCICON1, kEnable);
    CHECK(b.codec.drives.back().driven == 0xE000);
    CHECK(b.codec.drives.back().levels % 0x10000 == 0);
    b.write(sfr::DCICON1, 0);
    CHECK(b.codec.drives.back().driven == 0xF000);
    CHECK(b.codec.drives.back().levels == 0xF000);
}

TEST_CASE("the 33FJ's reports words lost by an interrupt of its own, once", "[dci]") {
    Bench b(dspic33fj256gp710());
    CodecPins codec;
    Ports ports{b.around, layout_dspic33fj256gp710().ports, codec};
    Dci dci{b.around, layout_dspic33fj256gp710().dci, b.clock, ports, codec};
    b.write(sfr33::TSCON, 1);
    b.write(sfr33::RSCON, 1);
    b.write(sfr33::DCICON2, 15);
    b.write(sfr33::DCICON3, 1);
    b.write(sfr33::TXBUF0, 0x1230);
    b.write(sfr33::DCICON1, kEnable | kLoop | kDjst);
    b.write(sfr33::TXBUF0, 0x4560);
    CHECK(b.until_flag(irq33::DCI, 1000) == 65);
    CHECK_FALSE(b.flag(irq33::DCIE));
    CHECK(b.read(sfr33::RXBUF0) == 0x1230);
    CHECK(b.until_flag(irq33::DCI, 1000) == 129);
    CHECK(b.take(irq33::DCIE));  // TXBUF0 was not written
    CHECK(b.until_flag(irq33::DCI, 1000) == 193);
    CHECK(b.take(irq33::DCIE));  // RXBUF0 was not read
    CHECK(b.until_flag(irq33::DCI, 1000) == 257);
    CHECK_FALSE(b.flag(irq33::DCIE));
}

TEST_CASE("the band gap takes 40 us, and LVDIF comes when the supply falls below the trip point", "[lvd]") {
    CodecPins pins;
    Bench b;
    LowVoltage detector{b.around, irq::LVD, pins};
    const auto rcon = [&](std::uint16_t value) {
        b.sfr.raw(sfr::RCON) = static_cast<std::uint16_t>((b.sfr.raw(sfr::RCON) & 0x2000) | value);
        detector.changed(kFcy);
    };
    detector.reset(false);
    rcon(0x0500);
    CHECK((b.sfr.raw(sfr::RCON) & 0x2000) == 0);
    rcon(0x1700);  // LVDL = 7: 3.09 V
    const Cycle stable = 1 + static_cast<Cycle>(40e-6 * kFcy);
    b.go(stable - 1);
    CHECK((b.sfr.raw(sfr::RCON) & 0x2000) == 0);
    b.go(stable);
    CHECK((b.sfr.raw(sfr::RCON) & 0x2000) != 0);
    CHECK_FALSE(b.take(irq::LVD));
    pins.volts_at_vdd = 3.10;
    detector.supply_changed(b.now);
    CHECK_FALSE(b.take(irq::LVD));
    pins.volts_at_vdd = 3.08;
    detector.supply_changed(b.now);
    CHECK(b.take(irq::LVD));
    pins.volts_at_vdd = 3.0;
    detector.supply_changed(b.now);
    CHECK_FALSE(b.take(irq::LVD));
    rcon(0x0700);
    CHECK((b.sfr.raw(sfr::RCON) & 0x2000) == 0);
    rcon(0x1700);
    b.go(b.now + stable);
    CHECK(b.take(irq::LVD));
    // With the brown-out detector on, the band gap is up already.
    detector.reset(true);
    rcon(0x0500);
    CHECK((b.sfr.raw(sfr::RCON) & 0x2000) != 0);
}
