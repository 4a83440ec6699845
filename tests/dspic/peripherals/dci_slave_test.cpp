// The data converter interface as slave of its codec: bit clock (CSCKD) and frame sync (COFSD) from outside.
// Sources: DS70286, DCICON1 (CSCKD, COFSD, DJST: fact sheet peripherals.md section 7). That a sync in
// mid-frame is not heard and that the module runs on in Sleep are assumptions (docs/fidelity.md).

#include "emu/dspic/peripherals/serial/dci.h"

#include "tests/dspic/chip30_bench.h"
#include "tests/dspic/peripherals/peripheral_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;
using cosim::kMicrosecond;
using cosim::Time;

namespace {

constexpr std::uint16_t kEnable = 0x8000, kBitClock = 0x0400, kFrameSync = 0x0100, kDjst = 0x0020;

struct SlavePins : FakePins {
    explicit SlavePins(const DciMaster& clocks) : codec{clocks} {}
    std::uint16_t dci_exchange(const DciWord& word, Cycle now) override { return codec.exchange(word, now); }
    DciMaster dci_master() const override { return codec.clocks; }
    MasterCodec codec;
};

struct SlaveBench : Bench {
    explicit SlaveBench(const DciMaster& clocks) : pins(clocks) {}
    SlavePins pins;
    Ports ports{around, layout_dspic30f6014a().ports, pins};
    Dci dci{around, layout_dspic30f6014a().dci, clock, ports, pins};

    void setup(unsigned words, unsigned bits, unsigned buffers, std::uint16_t slots, unsigned bcg) {
        write(sfr::DCICON2, static_cast<std::uint16_t>((buffers - 1) << 10 | (words - 1) << 5 | (bits - 1)));
        write(sfr::TSCON, slots);
        write(sfr::RSCON, slots);
        write(sfr::DCICON3, static_cast<std::uint16_t>(bcg));
    }
    /// When the codec's bit `number` begins.
    Cycle bit(std::uint64_t number) const {
        return clock.first_cycle_at(pins.codec.clocks.first +
                                    static_cast<Time>(number) * pins.codec.clocks.bit);
    }
    const std::vector<Cycle>& times() const { return pins.codec.times; }
};

}  // namespace

TEST_CASE("a slave's words go by the codec's bit clock and frame sync, to the cycle", "[dci]") {
    for (const unsigned djst : {0u, 1u}) {
        CAPTURE(djst);
        const unsigned delay = 1 - djst;
        SlaveBench b(codec_clocks(2'048'000.0, 256, 10 * kMicrosecond));
        b.setup(2, 16, 2, 3, 0);  // BCG = 0: no clock of its own
        b.write(sfr::TXBUF0, 0xABCD);
        b.write(sfr::TXBUF1, 0x4321);
        b.write(sfr::DCICON1, static_cast<std::uint16_t>(kEnable | kBitClock | kFrameSync | djst * kDjst));
        CHECK(b.until_flag(irq::DCI, 10'000) == b.bit(delay + 32));
        REQUIRE(b.times().size() == 2);
        CHECK(b.times()[0] == b.bit(delay + 16));
        CHECK(b.pins.codec.heard[0].value == 0xABCD);
        CHECK(b.pins.codec.heard[1].value == 0x4321);
        CHECK(b.pins.codec.heard[1].slot == 1);
        CHECK(b.pins.codec.heard[0].frame == b.bit(delay));
        CHECK(b.pins.codec.heard[0].bit_cycles == 7);  // 14.7456 MHz / 2.048 MHz = 7.2
        CHECK(b.read(sfr::RXBUF0) == MasterCodec::sent(0));
        CHECK(b.read(sfr::RXBUF1) == MasterCodec::sent(1));
        for (unsigned frame = 1; frame < 200; ++frame)
            CHECK(b.until_flag(irq::DCI, 1'000'000) == b.bit(256 * frame + delay + 32));
        CHECK(b.times().size() == 400);
    }
}

TEST_CASE("a codec that is switched on later, or is under way already, starts with its next frame sync",
          "[dci]") {
    SlaveBench b(codec_clocks(1'000'000.0, 64, 200 * kMicrosecond));
    b.setup(1, 16, 1, 1, 5);  // BCG does not matter
    const auto on = static_cast<std::uint16_t>(kEnable | kBitClock | kFrameSync | kDjst);
    b.write(sfr::DCICON1, on);
    b.go(b.bit(16) - 1);
    CHECK(b.times().empty());
    CHECK(b.until_flag(irq::DCI, 100'000) == b.bit(16));
    b.write(sfr::DCICON1, 0);
    b.go(b.bit(100));
    b.write(sfr::DCICON1, on);
    CHECK(b.until_flag(irq::DCI, 100'000) == b.bit(128 + 16));
}

TEST_CASE("a frame sync while a frame is under way is not heard, one with its last bit is", "[dci]") {
    const auto on = static_cast<std::uint16_t>(kEnable | kBitClock | kFrameSync);
    SlaveBench busy(codec_clocks(1'000'000.0, 20, 0));
    busy.setup(2, 16, 2, 3, 0);  // 32 bits: every second sync
    busy.write(sfr::DCICON1, on);
    const Cycle first = busy.until_flag(irq::DCI, 100'000);
    CHECK(first == busy.bit(20 + 1 + 32));  // the sync of bit 0 came before DCIEN
    CHECK(busy.until_flag(irq::DCI, 100'000) == busy.bit(20 + 40 + 1 + 32));

    SlaveBench close(codec_clocks(1'000'000.0, 32, 0));
    close.setup(2, 16, 2, 3, 0);
    close.write(sfr::DCICON1, on);
    CHECK(close.until_flag(irq::DCI, 100'000) == close.bit(32 + 1 + 32));
    CHECK(close.until_flag(irq::DCI, 100'000) == close.bit(64 + 1 + 32));
}

TEST_CASE("the codec's bit clock alone carries frames of COFSG + 1 words", "[dci]") {
    SlaveBench b(codec_clocks(1'000'000.0, 0, kMicrosecond));
    b.setup(4, 10, 1, 1, 0);
    b.write(sfr::DCICON1, kEnable | kBitClock);
    for (unsigned frame = 0; frame < 50; ++frame)
        CHECK(b.until_flag(irq::DCI, 1'000'000) == b.bit(1 + 40 * frame + 10));
    // Without frame sync from anybody nothing moves.
    SlaveBench none(codec_clocks(1'000'000.0, 0, kMicrosecond));
    none.setup(4, 10, 1, 1, 3);
    none.write(sfr::DCICON1, kEnable | kBitClock | kFrameSync);
    none.go(1'000'000);
    CHECK(none.times().empty());
}

TEST_CASE("frame syncs of a codec that counts the chip's bit clock", "[dci]") {
    SlaveBench b(codec_clocks(0.0, 100, 0));
    b.setup(2, 16, 1, 1, 1);  // a bit of 4 cycles
    b.write(sfr::DCICON1, kEnable | kFrameSync | kDjst);
    for (unsigned frame = 0; frame < 20; ++frame)
        CHECK(b.until_flag(irq::DCI, 100'000) == 1 + 4 * (100 * frame + 16));
    b.dci.hold(true);  // Idle with DCISIDL: its own clock stands still
    const Cycle held = b.now;
    b.go(held + 12'345);
    b.dci.hold(false);
    CHECK(b.until_flag(irq::DCI, 100'000) == held + 12'345 + 400);
}

TEST_CASE("SLOT of a slave is that of the word under way, and 0 between frames", "[dci]") {
    SlaveBench b(codec_clocks(1'000'000.0, 128, 0));
    b.setup(4, 16, 1, 0xF, 0);
    b.write(sfr::DCICON1, kEnable | kBitClock | kFrameSync | kDjst);
    b.go(b.bit(128));
    for (unsigned number = 128; number < 512; ++number) {
        b.go(b.bit(number));
        const unsigned into = number % 128;
        CHECK((b.read(sfr::DCISTAT) >> 8) == (into < 64 ? into / 16 : 0));
    }
}

TEST_CASE("without BCG at a frame's end the module waits for a clock, and goes on with one", "[dci]") {
    SlaveBench b({});
    b.setup(1, 16, 1, 1, 1);
    b.write(sfr::DCICON1, kEnable | kDjst);
    CHECK(b.until_flag(irq::DCI, 1000) == 65);
    b.write(sfr::DCICON3, 0);
    b.go(10'000);
    CHECK(b.times().size() == 2);  // the frame that had begun
    b.take(irq::DCI);
    b.write(sfr::DCICON3, 1);
    CHECK(b.until_flag(irq::DCI, 20'000) == 10'001 + 64);
}

TEST_CASE("a program sends its codec back what it hears, asleep between the words", "[dci]") {
    // A frame of 32 bits at 128 kHz: a word each 250 us. The module runs on in Sleep and wakes the CPU by
    // DCIIF, which the crystal's start makes 170 us late.
    Bench30 bench(R"(
        .org 0x200
main:   mov #0x000f, w0                 ; one word of 16 bits, an interrupt each
        mov w0, DCICON2
        mov #1, w0
        mov w0, TSCON
        mov w0, RSCON
        mov #0x8520, w0                 ; DCIEN, CSCKD, COFSD, DJST
        mov w0, DCICON1
        bset IEC2, #9                   ; DCIIE
        mov #0xe0, w0
        mov w0, SR
loop:   pwrsav #0
        bclr IFS2, #9
        mov RXBUF0, w0
        mov w0, TXBUF0
        inc 0x1000
        bra loop
)",
                  {}, 0xFFE6, {}, codec_clocks(128'000.0, 32, 100 * kMicrosecond));
    bench.chip.run_until(10 * cosim::kMillisecond);
    const MasterCodec& codec = bench.pins.codec;
    REQUIRE(codec.heard.size() == 40);  // (9.9 ms - 16 bits) / 250 us = 39.1
    for (std::size_t i = 2; i < codec.heard.size(); ++i) {
        CAPTURE(i);
        CHECK(codec.heard[i].value == MasterCodec::sent(i - 2));
        CHECK(codec.times[i] == bench.chip.clock().first_cycle_at(
                                    codec.clocks.first + static_cast<Time>(32 * i + 16) * codec.clocks.bit));
    }
    CHECK(bench.word(0x1000) == 39);  // the CPU still wakes up for the last
}
