// SPI1 and SPI2 of the 30F: words as master, bits at the pins as slave, frame pulses.

#include "base/random.h"
#include "tests/dspic/chip30_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

constexpr auto F = PortLetter::F;
constexpr auto B = PortLetter::B;
constexpr auto G = PortLetter::G;
constexpr int kSck = 6, kSdi = 7, kSdo = 8, kSs = 2;

/// SPI1CON as given, the module on; `more` follows, then for ever.
std::string program(int con, const std::string& more) {
    return "        .org 0x200\nmain:\n        setm ADPCFG\n        mov #" + std::to_string(con) +
           ", w0\n        mov w0, SPI1CON\n        bset SPI1STAT, #15\non:\n" + more +
           "ready:  repeat #0x3ff\n        nop\n        bra ready\n";
}

/// A master outside: one word, most significant bit first, `half` cycles a level, its first edge at `at`.
std::uint16_t clock_word(Bench30& bench, int con, std::uint16_t out, int bits, Cycle at, Cycle half) {
    const bool ckp = con & 0x40, cke = con & 0x100;
    const auto sdo = [&] { return bench.pins.levels_now[5] >> kSdo & 1; };
    std::uint16_t in = 0;
    for (int i = bits - 1; i >= 0; --i) {
        bench.set(F, kSdi, out >> i & 1, cke ? at - half / 2 : at);
        if (cke) bench.go(at), in = static_cast<std::uint16_t>(in << 1 | sdo());
        bench.set(F, kSck, !ckp, at);
        if (!cke) bench.go(at + half), in = static_cast<std::uint16_t>(in << 1 | sdo());
        bench.set(F, kSck, ckp, at + half);
        at += 2 * half;
    }
    return in;
}

}  // namespace

TEST_CASE(
    "a master's word takes its bits at the prescaled clock, the next one waits behind it (fact sheet 8)") {
    struct Clock {
        int bits, cycles;
    };
    for (const Clock& clock : {Clock{0x3 | 0x6 << 2, 2}, Clock{0x2 | 0x7 << 2, 4}, Clock{0x1 | 0x4 << 2, 64},
                               Clock{0x0 | 0x0 << 2, 512}})
        for (const int wide : {0, 1}) {
            CAPTURE(clock.cycles, wide);
            Bench30 bench(program(0x20 | clock.bits | wide << 10, R"(
        mov #0xa55a, w0
        mov w0, SPI1BUF
first:  mov #0x1234, w0
        mov w0, SPI1BUF
        mov #0xffff, w0
        mov w0, SPI1BUF                 ; the buffer is full: dropped
        mov SPI1STAT, w1
        mov w1, 0x1000
)"));
            const Cycle begun = bench.run_to("first");
            bench.run_to("ready");
            const Cycle word = static_cast<Cycle>(clock.cycles) * (wide ? 16 : 8);
            bench.pins.spi_answer = 0xBEEF;
            bench.go(begun + word);
            CHECK((bench.reg("IFS0") & 0x100) == 0);
            bench.go(begun + 1 + word);
            CHECK((bench.reg("IFS0") & 0x100) == 0x100);
            CHECK((bench.reg("SPI1STAT") & 1) == 1);
            bench.go(begun + 1 + 2 * word);
            REQUIRE(bench.pins.words.size() == 2);
            CHECK(bench.pins.words[0].sent == (wide ? 0xA55A : 0x5A));
            CHECK(bench.pins.words[0].at == begun + word);
            CHECK(bench.pins.words[1].sent == (wide ? 0x1234 : 0x34));
            CHECK(bench.pins.words[1].at == begun + 2 * word);
            CHECK((bench.reg("SPI1STAT") & 0x43) == 0x41);  // nobody read the first: overflow
            if (word > 16) CHECK((bench.word(0x1000) & 2) == 2);
        }
}

TEST_CASE("a slave shifts bit by bit at its pins in all four modes, 8 and 16 bits") {
    RandomStream random(3, "words");
    for (const int mode : {0x000, 0x040, 0x100, 0x140})
        for (const int wide : {0, 0x400}) {
            const int con = mode | wide | 0x80;  // SSEN
            CAPTURE(mode, wide);
            const int bits = wide ? 16 : 8;
            const auto mask = static_cast<std::uint16_t>((1u << bits) - 1);
            const auto own = static_cast<std::uint16_t>(random.below(0x10000));
            Bench30 bench(
                program(con, "        mov #" + std::to_string(own) + ", w0\n        mov w0, SPI1BUF\n"));
            bench.pins.outside[5] = mode & 0x40 ? 1 << kSck : 0;
            bench.pins.outside[1] = 1 << kSs;
            bench.run_to("ready");
            // Not selected: neither heard nor driven.
            clock_word(bench, con, 0x55, bits, 1000, 8);
            CHECK((bench.reg("SPI1STAT") & 1) == 0);
            CHECK((bench.pins.driven_now[5] & 1 << kSdo) == 0);
            bench.set(B, kSs, false, 1500);
            const auto out = static_cast<std::uint16_t>(random.below(0x10000) & mask);
            const std::uint16_t in = clock_word(bench, con, out, bits, 2000, 8);
            bench.go(2600);
            CHECK((bench.pins.driven_now[5] & 1 << kSdo) != 0);
            CHECK(in == (own & mask));
            CHECK(bench.reg("SPI1BUF") == out);
            CHECK((bench.reg("SPI1STAT") & 3) == 1);
            CHECK((bench.reg("IFS0") & 0x100) == 0x100);
            clock_word(bench, con, 0x77, bits, 3000, 8);  // the first was not read
            bench.go(3600);
            CHECK((bench.reg("SPI1STAT") & 0x40) == 0x40);
            CHECK(bench.reg("SPI1BUF") == out);
        }
}

TEST_CASE("SS high ends a slave's word half way: the next one begins with its first bit") {
    const int con = 0x80;
    Bench30 bench(program(con, {}));
    bench.run_to("ready");
    clock_word(bench, con, 0x7, 3, 1000, 8);
    bench.set(B, kSs, true, 1200);
    bench.set(B, kSs, false, 1300);
    clock_word(bench, con, 0xC3, 8, 1400, 8);
    bench.go(2000);
    CHECK(bench.reg("SPI1BUF") == 0xC3);
}

TEST_CASE("a frame master's pulse is one clock long and one clock before the word, on its clock's edges") {
    // FRMEN, MSTEN, 4:1 times 2:1 = 8 cycles a clock.
    Bench30 bench(program(0x4020 | 0x2 | 0x6 << 2, R"(
        repeat #100
        nop
        mov #0x96, w0
        mov w0, SPI1BUF
)"));
    const Cycle on = bench.run_to("on");
    const Cycle begun = bench.run_to("ready");
    bench.go(begun + 200);
    const auto& edges = bench.edges(B, kSs);
    REQUIRE(edges.size() == 2);
    CHECK(edges[0].level);
    CHECK((edges[0].at - on) % 8 == 0);
    CHECK(edges[0].at >= begun);
    CHECK(edges[0].at < begun + 8);
    CHECK(edges[1] == Pins30::Edge{edges[0].at + 8, false});
    REQUIRE(bench.pins.words.size() == 1);
    CHECK(bench.pins.words[0].at == edges[1].at + 64);
}

TEST_CASE("a frame slave's word waits for the pulse on SS") {
    Bench30 bench(program(0x6020 | 0x2 | 0x6 << 2, R"(
        mov #0x96, w0
        mov w0, SPI1BUF
)"));
    const Cycle on = bench.run_to("on");
    bench.go(3000);
    CHECK(bench.pins.words.empty());
    bench.pulse(B, kSs, 3001, 8);
    bench.go(3500);
    REQUIRE(bench.pins.words.size() == 1);
    const Cycle start = bench.pins.words[0].at - 64;
    CHECK((start - on) % 8 == 0);
    CHECK(start >= 3001);
    CHECK(start < 3010);
}

TEST_CASE("SPI2 has its own pins and interrupt") {
    Bench30 bench(R"(
        .org 0x200
main:   mov #0x23, w0
        mov w0, SPI2CON
        bset SPI2STAT, #15
        mov #0x5a, w0
        mov w0, SPI2BUF
ready:  bra ready
)");
    bench.go(1000);
    REQUIRE(bench.pins.words.size() == 1);
    CHECK(bench.pins.words[0].unit == 2);
    CHECK((bench.reg("IFS1") & 0x400) == 0x400);
    CHECK((bench.pins.driven_now[static_cast<std::size_t>(G)] & 0x3C0) == 0x140);
}
