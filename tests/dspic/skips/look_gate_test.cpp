// Runs that end where the program would look at what is not known yet (chip/look_gate.h).

#include "emu/dspic/chip/look_gate.h"
#include "tests/dspic/chip33_bench.h"

#include <catch2/catch.hpp>

#include <string_view>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

constexpr std::string_view kLooks[] = {"PORTD"};

/// It changes port B, passes some 55 us, and looks at port D by this instruction.
std::string program(const std::string& look) {
    return "        .org 0x200\n"
           "main:   mov #0x1800, w15\n"
           "        mov #PORTD, w1\n"
           "        clr TRISB\n"
           "loop:   com LATB\n"
           "        repeat #200\n"
           "        nop\n" +
           look +
           "\n"
           "        bra loop\n";
}

}  // namespace

TEST_CASE("a run ends before the first look at or after what is known") {
    for (const char* look :
         {"mov PORTD, w0", "btst PORTD, #3", "mov [w1], w0", "mov [w1++], w0\n dec2 w1, w1"}) {
        INFO(look);
        Bench33 whole(program(look)), gated(program(look));
        LookGate gate(gated.chip, kLooks, {});
        constexpr cosim::Time kEnd = 20 * cosim::kMillisecond, kPiece = 330 * cosim::kMicrosecond,
                              kLoop = 60 * cosim::kMicrosecond;
        whole.chip.run_until(kEnd);
        REQUIRE(gate.applies());
        for (cosim::Time known = kPiece; known + kLoop < kEnd; known += kPiece) {
            gate.open(known);
            gated.chip.run_until(kEnd);
            REQUIRE(gate.held());
            const cosim::Time held = gated.chip.now();
            CHECK(held >= known);
            CHECK(held < known + kLoop);
            gated.chip.run_until(kEnd);  // nothing more is known
            CHECK(gate.held());
            CHECK(gated.chip.now() == held);
            gate.lift();
        }
        gated.chip.run_until(kEnd);
        CHECK_FALSE(gate.held());
        CHECK(gated.chip.now() == kEnd);
        CHECK(gated.chip.cycle() == whole.chip.cycle());
        REQUIRE(gated.pins.edges.size() == whole.pins.edges.size());
        for (std::size_t i = 0; i < gated.pins.edges.size(); ++i)
            REQUIRE(gated.pins.edges[i].at == whole.pins.edges[i].at);
    }
}

TEST_CASE("a program that does not look is not held") {
    Bench33 bench(program("mov LATD, w0"));
    LookGate gate(bench.chip, kLooks, {});
    bench.chip.run_until(cosim::kMillisecond);  // what it never executed might be anything
    gate.open(cosim::kMillisecond);
    bench.chip.run_until(5 * cosim::kMillisecond);
    CHECK_FALSE(gate.held());
    CHECK(bench.chip.now() == 5 * cosim::kMillisecond);
}

TEST_CASE("a reset waits at the gate") {
    Bench33 bench("        .org 0x200\nmain:   reset\n");
    LookGate gate(bench.chip, kLooks, {});
    gate.open(10 * cosim::kMicrosecond);
    bench.chip.run_until(5 * cosim::kMillisecond);
    CHECK(gate.held());
    CHECK(bench.chip.now() < 15 * cosim::kMicrosecond);
}

TEST_CASE("a converter at work looks by itself") {
    Bench33 bench("        .org 0x200\n"
                  "main:   mov #0x8004, w0\n"  // ADON, ASAM
                  "        mov w0, AD1CON1\n"
                  "stay:   bra stay\n");
    LookGate gate(bench.chip, kLooks, {});
    CHECK(gate.applies());
    bench.chip.run_until(cosim::kMillisecond);
    CHECK_FALSE(gate.applies());
}
