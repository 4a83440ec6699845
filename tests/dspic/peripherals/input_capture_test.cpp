// IC1 to IC8: what is captured when, from pins driven at drawn cycles. Each rule with its source.

#include "base/random.h"
#include "tests/dspic/chip30_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

constexpr auto D = PortLetter::D;
constexpr int kIc1 = 8, kIc2 = 9;  // RD8, RD9

/// Timer2 and Timer3 free-running, Timer3 by eight; `setup` follows; then for ever.
std::string program(const std::string& setup) {
    return R"(
        .org 0x16
        .pword ic1
        .org 0x200
main:   mov #0x0900, w15
        mov #0x27f0, w0
        mov w0, SPLIM
        setm PR2
        setm PR3
        mov #0x8010, w0
        mov w0, T3CON
        mov #0x8000, w0
        mov w0, T2CON
started:
)" + setup +
           R"(
ready:  bra ready
ic1:    bclr IFS0, #1
        inc 0x1000
        mov #0x1010, w2
        btsc IC1CON, #3
        mov IC1BUF, w3
        mov w3, [w2]
        retfie
)";
}

}  // namespace

TEST_CASE("each mode captures its edges, one cycle after the edge (DS70060 13.4)") {
    // The count that Timer2 shows in cycle c is c - t2.
    struct Case {
        int mode;
        int captures;  // of four pulses
    };
    for (const Case& one : {Case{1, 4}, Case{2, 4}, Case{3, 4}, Case{4, 1}, Case{5, 0}}) {
        CAPTURE(one.mode);
        Bench30 bench(
            program("        mov #0x0080 + " + std::to_string(one.mode) + ", w0\n        mov w0, IC1CON\n"));
        const Cycle t2 = bench.run_to("started");
        bench.run_to("ready");
        RandomStream random(11, "pulses");
        std::vector<int> expected;
        Cycle at = bench.chip.cycle() + 10;
        for (int i = 0; i < 4; ++i) {
            at += 5 + random.below(3000);
            const Cycle width = 2 + random.below(100);
            bench.pulse(D, kIc1, at, width);
            const auto count = [&](Cycle edge) { return static_cast<int>(edge + 1 - t2) & 0xFFFF; };
            if (one.mode == 1 || one.mode == 3) expected.push_back(count(at));
            if (one.mode == 1 || one.mode == 2) expected.push_back(count(at + width));
            if (one.mode == 4 && i == 3) expected.push_back(count(at));
            at += width;
        }
        bench.go(at + 5);
        if (expected.size() > 4) expected.resize(4);
        REQUIRE(static_cast<int>(expected.size()) == one.captures);
        CHECK(((bench.reg("IC1CON") & 8) != 0) == (one.captures > 0));
        CHECK(((bench.reg("IFS0") & 2) != 0) == (one.captures > 0));
        // Mode 1 does not overflow (DS70150E 12.1.4); nobody else had a fifth edge.
        CHECK((bench.reg("IC1CON") & 0x10) == 0);
    }
}

TEST_CASE("captured counts come out in order, from the timer that ICTMR names") {
    Bench30 bench(program(R"(
        mov #0x0083, w0
        mov w0, IC1CON
        mov #0x0003, w0
        mov w0, IC2CON
wait:   btss IFS0, #1
        bra wait
        mov IC1BUF, w4
        mov IC1BUF, w5
        mov IC2BUF, w6
        mov w4, 0x1000
        mov w5, 0x1002
        mov w6, 0x1004
read:
)"));
    const Cycle t2 = bench.run_to("started");
    const Cycle t3 = t2 - 2;  // Timer3 was switched on two cycles before
    bench.run_to("wait");
    bench.pulse(D, kIc2, 5000, 10);
    bench.chip.run_until(bench.chip.clock().time_of(5100));
    bench.set(D, kIc1, true, 6000);
    bench.set(D, kIc1, false, 6001);
    bench.set(D, kIc1, true, 6002);
    bench.run_to("read");
    CHECK(bench.word(0x1000) == static_cast<int>(6001 - t2));
    CHECK(bench.word(0x1002) == static_cast<int>(6003 - t2));
    CHECK(bench.word(0x1004) == static_cast<int>((5001 - t3) / 8));
    CHECK((bench.reg("IC1CON") & 8) == 0);
}

TEST_CASE(
    "the fifth capture overflows, and nothing is captured until four words were read (DS70150E 12.1.2)") {
    Bench30 bench(program(R"(
        mov #0x00A3, w0                 ; every rising edge, interrupt on every second one
        mov w0, IC1CON
loop:   btss PORTF, #0
        bra loop
        mov IC1BUF, w3
        mov w3, 0x1000
        mov IC1BUF, w3
        mov w3, 0x1002
        mov IC1BUF, w3
        mov w3, 0x1004
        mov IC1BUF, w3
        mov w3, 0x1006
read:
)"));
    const Cycle t2 = bench.run_to("started");
    bench.run_to("loop");
    for (int i = 0; i < 7; ++i)
        bench.pulse(D, kIc1, 1000 + 100 * static_cast<Cycle>(i), 3);
    CHECK((bench.reg("IC1CON") & 0x18) == 0x18);
    bench.set(PortLetter::F, 0, true, 2000);
    bench.run_to("read");
    for (int i = 0; i < 4; ++i)
        CHECK(bench.word(0x1000 + 2 * i) == static_cast<int>(1001 + 100 * static_cast<Cycle>(i) - t2));
    CHECK((bench.reg("IC1CON") & 0x18) == 0);
    bench.pulse(D, kIc1, 3000, 3);
    bench.go(3010);
    CHECK((bench.reg("IC1CON") & 0x18) == 0x08);
}

TEST_CASE("ICI chooses how many captures make an interrupt, off clears buffer and prescaler") {
    for (int ici = 0; ici < 4; ++ici) {
        CAPTURE(ici);
        Bench30 bench(program("        bset IEC0, #1\n        mov #0x0083 + 32 * " + std::to_string(ici) +
                              ", w0\n        mov w0, IC1CON\n"));
        bench.run_to("ready");
        for (int i = 0; i < 24; ++i)  // the routine reads one word an interrupt
            bench.pulse(D, kIc1, 1000 + 100 * static_cast<Cycle>(i), 3);
        bench.go(4000);
        if (ici == 0) CHECK(bench.word(0x1000) == 24);
        if (ici == 1) CHECK(bench.word(0x1000) >= 3);
        // A routine that reads too little is stopped by the overflow, but for ICI = 0.
        if (ici > 1) CHECK(bench.word(0x1000) < 24 / (ici + 1));
    }
    Bench30 bench(program(R"(
        mov #0x0084, w0
        mov w0, IC1CON
loop:   btss PORTF, #0
        bra loop
        clr IC1CON
        mov #0x0084, w0
        mov w0, IC1CON
again:  bra again
)"));
    bench.run_to("loop");
    for (int i = 0; i < 7; ++i)
        bench.pulse(D, kIc1, 1000 + 100 * static_cast<Cycle>(i), 3);
    bench.go(1900);
    CHECK((bench.reg("IC1CON") & 8) == 8);
    bench.set(PortLetter::F, 0, true, 2000);
    bench.run_to("again");
    CHECK((bench.reg("IC1CON") & 8) == 0);
    for (int i = 0; i < 3; ++i)
        bench.pulse(D, kIc1, 3000 + 100 * static_cast<Cycle>(i), 3);
    bench.go(3900);
    CHECK((bench.reg("IC1CON") & 8) == 0);  // the three edges before were forgotten
    bench.pulse(D, kIc1, 4000, 3);
    bench.go(4010);
    CHECK((bench.reg("IC1CON") & 8) == 8);
}

TEST_CASE("ICM = 7 wakes from Sleep by a rising edge, the timer's clock stands still (DS70150E 12.2)") {
    Bench30 bench(program(R"(
        mov #0x0087, w0
        mov w0, IC1CON
        bset IEC0, #1
        bclr IFS0, #1
sleep:  pwrsav #0
woken:
)"));
    bench.run_to("sleep");
    bench.pulse(D, kIc1, 10'000, 5);  // falls asleep well before
    const Cycle woken = bench.run_to("woken");
    // After Sleep the crystal and its PLL start: 10 us, 1024 periods, 20 us (DS70143, AC characteristics).
    const auto start = static_cast<Cycle>((10e-6 + 1024 / 7'372'800.0 + 20e-6) * 14'745'600.0);
    CHECK(woken >= 10'000 + start);
    CHECK(woken < 10'020 + start);
    CHECK(bench.word(0x1000) == 1);
    CHECK((bench.reg("IC1CON") & 8) == 0);
    CHECK((bench.reg("RCON") & 8) == 8);
}

TEST_CASE("a saved state goes on capturing as the chip does") {
    const std::string source =
        program("        bset IEC0, #1\n        mov #0x0084, w0\n        mov w0, IC1CON\n");
    Bench30 first(source), second(source);
    first.run_to("ready");
    for (int i = 0; i < 6; ++i)
        first.pulse(D, kIc1, 1000 + 100 * static_cast<Cycle>(i), 3);
    std::vector<std::uint8_t> bytes;
    StateWriter writer(bytes);
    first.chip.state(writer);
    StateReader reader(bytes);
    second.chip.state(reader);
    for (Bench30* bench : {&first, &second}) {
        for (int i = 0; i < 2; ++i)
            bench->pulse(D, kIc1, 2000 + 100 * static_cast<Cycle>(i), 3);
        bench->go(3000);
        CHECK(bench->word(0x1000) == 2);
    }
    CHECK(first.word(0x1010) == second.word(0x1010));
}
