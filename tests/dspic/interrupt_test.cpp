// Interrupts, traps and resets, as the reference manual describes them.

#include "tests/dspic/rig.h"

#include <catch2/catch.hpp>

using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

constexpr int kT1 = 3;  // IRQ numbers
constexpr int kT2 = 6;
constexpr int kT3 = 7;
constexpr std::uint16_t kSr = 0x042;

int vector_of(int irq) {
    return kTrapVectors + irq;
}

std::string nops(int count) {
    std::string text;
    for (int i = 0; i < count; ++i)
        text += "        nop\n";
    return text;
}

/// Straight NOPs with a stack, and a handler that clears T1IF.
const std::string kNops = "        mov #0x1000, w15\n        bset 0x8c, #3\nhere:\n" + nops(60) +
                          "end:    bra end\nisr:    bclr 0x84, #3\n        retfie\n";

}  // namespace

TEST_CASE("the first instruction of the handler runs in the fifth cycle after the flag's") {
    Rig rig(kNops);
    rig.vector(vector_of(kT1), "isr");
    REQUIRE(rig.run_to("here"));
    Raiser t1(rig, kT1);
    const Cycle flagged = rig.core.cycle() + 7;
    t1.at(flagged);
    REQUIRE(rig.run_to("isr"));
    CHECK(rig.core.cycle() == flagged + 5);
    // One-cycle instructions 0..7 ran: the one in the flag's cycle completes.
    CHECK(rig.data(0x1000) == rig.program.symbol("here") + 2 * 8);
    CHECK(rig.core.cpu_level() == 4);
    CHECK(rig.log == std::vector<std::string>{"interrupt T1"});
}

TEST_CASE("latency is the same when the flag falls into a two-cycle instruction") {
    for (Cycle offset = 0; offset < 6; ++offset) {
        Rig rig("        mov #0x1000, w15\n        bset 0x8c, #3\nhere:   bra next\nnext:   bra "
                "third\nthird:  bra "
                "here\nisr:    retfie\n");
        rig.vector(vector_of(kT1), "isr");
        REQUIRE(rig.run_to("here"));
        Raiser t1(rig, kT1);
        const Cycle flagged = rig.core.cycle() + offset;
        t1.at(flagged);
        REQUIRE(rig.run_to("isr"));
        CHECK(rig.core.cycle() == flagged + 5);
    }
}

TEST_CASE("RETFIE takes 3 cycles and restores status and level") {
    Rig rig(kNops);
    rig.vector(vector_of(kT1), "isr");
    REQUIRE(rig.run_to("here"));
    rig.core.write_data(kSr, 0x010B);
    Raiser t1(rig, kT1);
    t1.at(rig.core.cycle() + 3);
    REQUIRE(rig.run_to("isr"));
    const std::uint32_t back = rig.data(0x1000);
    const Cycle start = rig.core.cycle();
    rig.core.step();  // BCLR
    rig.core.step();  // RETFIE
    CHECK(rig.core.cycle() == start + 1 + 3);
    CHECK(rig.core.pc() == back);
    CHECK(rig.core.cpu_level() == 0);
    CHECK((rig.data(kSr) & 0x00FF) == 0x000B);
    CHECK(rig.w(15) == 0x1000);
}

TEST_CASE("a higher priority nests, an equal one waits, NSTDIS forbids nesting") {
    const std::string source = R"(
        mov     #0x1000, w15
        mov     #0x00C8, w0
        mov     w0, 0x8c            ; T1IE, T2IE, T3IE
        mov     w2, 0x80            ; INTCON1
        mov     #0x5004, w0
        mov     #0x3004, w0
        mov     w0, 0x94            ; T1IP = 3
        mov     #0x3500, w0
        mov     w0, 0x96            ; T3IP = 3, T2IP = 5
here:   bra     here
t1:     bclr    0x84, #3
        nop
        nop
        nop
        nop
        nop
        nop
t1end:  retfie
t2:     bclr    0x84, #6
        retfie
t3:     bclr    0x84, #7
        retfie
)";
    for (const bool nesting : {true, false}) {
        Rig rig(source);
        rig.core.set_w(2, nesting ? 0x0000 : 0x8000);
        rig.vector(vector_of(kT1), "t1");
        rig.vector(vector_of(kT2), "t2");
        rig.vector(vector_of(kT3), "t3");
        REQUIRE(rig.run_to("here"));
        Raiser t1(rig, kT1), t2(rig, kT2), t3(rig, kT3);
        const Cycle now = rig.core.cycle();
        t1.at(now + 10);
        t2.at(now + 18);
        t3.at(now + 17);
        REQUIRE(rig.run_to("t1end"));
        if (nesting)
            CHECK(rig.log == std::vector<std::string>{"interrupt T1", "interrupt T2"});
        else
            CHECK(rig.log == std::vector<std::string>{"interrupt T1"});
        rig.core.run(rig.core.cycle() + 60);
        CHECK(rig.log.size() == 3);
        CHECK(rig.log.back() == "interrupt T3");
        CHECK(rig.core.cpu_level() == 0);
    }
}

TEST_CASE("of equal priorities the lower number goes first, whatever came first") {
    Rig rig("        mov #0x1000, w15\n        mov #0xC8, w0\n        mov w0, 0x8c\nhere:   disi #50\n"
            "loop:   bra loop\nisr:    clr 0x84\n        retfie\n");
    rig.vector(vector_of(kT1), "isr");
    rig.vector(vector_of(kT3), "isr");
    REQUIRE(rig.run_to("loop"));
    Raiser t1(rig, kT1), t3(rig, kT3);
    t3.at(rig.core.cycle() + 2);
    t1.at(rig.core.cycle() + 9);
    REQUIRE(rig.run_to("isr"));
    CHECK(rig.log == std::vector<std::string>{"interrupt T1"});
}

TEST_CASE("DISI holds priorities 1 to 6 for its count and one cycle, 7 passes") {
    for (const int priority : {6, 7}) {
        Rig rig("        mov #0x1000, w15\n        bset 0x8c, #3\n        mov w1, 0x94\nhere:   disi #20\n"
                "loop:   nop\n        nop\n        nop\n        nop\n        nop\n        nop\n        nop\n"
                "        nop\n        nop\n        nop\n        bra loop\nisr:    retfie\n");
        rig.vector(vector_of(kT1), "isr");
        rig.core.set_w(1, static_cast<std::uint16_t>(priority << 12));
        REQUIRE(rig.run_to("here"));
        const Cycle disi = rig.core.cycle();
        Raiser t1(rig, kT1);
        t1.at(disi + 4);
        REQUIRE(rig.run_to("isr"));
        // Eligible in the 21st cycle after the DISI's own, counted from it.
        CHECK(rig.core.cycle() == (priority == 7 ? disi + 4 : disi + 21) + 5);
    }
}

TEST_CASE("software sets a flag, priority 0 is never taken, ALTIVT moves the table") {
    Rig rig(R"(
        mov     #0x1000, w15
        bset    0x8c, #3
        bset    0x8c, #6
        mov     #0x4444, w0
        mov     #0x4044, w1
        mov     w1, 0x96            ; T2IP = 0
        bset    0x82, #15           ; ALTIVT
        bset    0x84, #6            ; T2IF: priority 0
        nop
        nop
here:   bset    0x84, #3
        nop
loop:   bra     loop
isr:    retfie
alt:    bra     alt
)");
    rig.vector(vector_of(kT1), "isr");
    rig.vector(vector_of(kT1), "alt", true);
    REQUIRE(rig.run_to("here"));
    CHECK(rig.log.empty());
    const Cycle set = rig.core.cycle();
    REQUIRE(rig.run_to("alt"));
    CHECK(rig.core.cycle() == set + 5);
}

TEST_CASE("the address error trap: a misaligned write is suppressed, the read completes") {
    Rig rig(R"(
        mov     #0x1000, w15
        mov     #0x1101, w1
        mov     #0x55AA, w2
bad:    mov     w2, [w1++]
        nop
        nop
        nop
after:  bra     after
trap:   bclr    0x80, #3
        retfie
)");
    rig.vector(2, "trap");
    REQUIRE(rig.run_to("trap"));
    CHECK(rig.data(0x1100) == 0);
    CHECK(rig.w(1) == 0x1103);
    CHECK(rig.core.cpu_level() == 13);
    CHECK(rig.data(0x1000) == rig.program.symbol("bad") + 2);
    CHECK(rig.log == std::vector<std::string>{"trap AddressError"});
    rig.core.step();
    rig.core.step();
    CHECK(rig.core.cpu_level() == 0);
    // ADDRERR was the flag: nothing brings the handler back.
    REQUIRE(rig.run_to("after"));
    CHECK(rig.log.size() == 1);
}

TEST_CASE("each trap sets its own flag of INTCON1, the address error goes before the stack error") {
    const struct {
        const char* cause;
        int vector;
        std::uint16_t flag;
    } cases[] = {{"bset 0x80, #1", 1, 1u << 1},              // OSCFAIL, set by software
                 {"mov 0x3000, w0", 2, 1u << 3},             // ADDRERR
                 {"mov #0x700, w15\n push w0", 3, 1u << 2},  // STKERR
                 {"mov #0x700, w15\n push 0x3000", 2, 3u << 2}};
    for (const auto& c : cases) {
        Rig rig("        mov #0x1000, w15\n" + std::string(c.cause) + "\n        nop\n        nop\n" +
                "loop:   bra loop\ntrap:   bra trap\n");
        rig.vector(c.vector, "trap");
        INFO(c.cause);
        REQUIRE(rig.run_to("trap"));
        CHECK((rig.data(0x80) & 0x1E) == c.flag);
    }
}

TEST_CASE("a trap flag left set re-enters after RETFIE") {
    Rig rig("        mov #0x1000, w15\n        mov 0x3000, w0\n        nop\nloop:   bra loop\ntrap:   inc "
            "w5, w5\n"
            "        retfie\n");
    rig.vector(2, "trap");
    rig.core.run(200);
    CHECK(rig.w(5) > 5);
}

TEST_CASE("SPLIM below the RAM leaves no legal stack address") {
    Rig rig("        mov #0x1000, w15\n        mov #0x0700, w0\n        mov w0, 0x20\n        push w0\n"
            "here:   bra here\ntrap:   bra trap\n");
    rig.vector(3, "trap");
    CHECK(rig.run_to("trap", 100));
}

TEST_CASE("the stack traps above SPLIM and below 0x0800") {
    Rig over(R"(
        mov     #0x1FFE, w0
        mov     w0, 0x20
        mov     w0, w15
        push    w0                  ; at SPLIM: legal
        nop
fine:   push    w0
        nop
        nop
trap:   bra     trap
)");
    over.vector(3, "trap");
    REQUIRE(over.run_to("fine"));
    CHECK(over.log.empty());
    REQUIRE(over.run_to("trap"));
    CHECK(over.log[0] == "trap StackError");
    CHECK(over.core.cpu_level() == 12);

    Rig under("        mov #0x802, w15\n        pop w0\nfine:   pop w0\n        nop\ntrap:   bra trap\n");
    under.vector(3, "trap");
    REQUIRE(under.run_to("fine"));
    CHECK(under.log.empty());
    REQUIRE(under.run_to("trap"));
}

TEST_CASE("dividing by zero traps on the first step and leaves the loop") {
    Rig rig(R"(
        mov     #0x1000, w15
        mov     #100, w4
        clr     w6
        repeat  #17
div:    div.sw  w4, w6
        nop
        nop
trap:   bra     trap
)");
    rig.vector(4, "trap");
    REQUIRE(rig.run_to("trap"));
    CHECK(rig.log == std::vector<std::string>{"trap MathError"});
    CHECK(rig.data(0x1000) == rig.program.symbol("div"));
    CHECK((rig.data(0x1002) >> 8 & 0x10) != 0);  // RA on the stack
    CHECK((rig.data(kSr) & 0x10) == 0);
    CHECK(rig.core.cpu_level() == 11);
}

TEST_CASE("OVATE traps on an accumulator overflow only when enabled") {
    for (const bool enabled : {true, false}) {
        Rig rig(R"(
        mov     #0x1000, w15
        mov     w1, 0x80
        mov     #0x7FFF, w4
        lac     w4, a
        add     w4, a
        nop
        nop
done:   bra     done
trap:   bra     trap
)");
        rig.core.set_w(1, enabled ? 0x0400 : 0);
        rig.vector(4, "trap");
        CHECK(rig.run_to(enabled ? "trap" : "done"));
    }
}

TEST_CASE("an address error under an oscillator failure is a trap conflict") {
    Rig rig("        mov #0x1000, w15\n        bset 0x80, #1\n        nop\n        nop\nloop:   bra loop\n"
            "osc:    mov 0x3000, w0\n        nop\n");
    rig.vector(1, "osc");
    rig.core.run(60);
    REQUIRE(rig.log.size() >= 2);
    CHECK(rig.log[0] == "trap OscillatorFail");
    CHECK(rig.log[1] == "reset trap conflict");
    CHECK((rig.data(0x740) & 0x8000) != 0);
}

TEST_CASE("fetching from vectors or beyond flash is an address error") {
    Rig vectors("        mov #0x1000, w15\n        mov #0x40, w0\n        goto w0\ntrap:   bra trap\n");
    vectors.vector(2, "trap");
    CHECK(vectors.run_to("trap"));
    Rig beyond("        mov #0x1000, w15\n        goto 0x20000\ntrap:   bra trap\n");
    beyond.vector(2, "trap");
    CHECK(beyond.run_to("trap"));
}

TEST_CASE("resets leave their cause in RCON") {
    const auto cause = [](const std::string& source, std::uint16_t bit, const std::string& name) {
        Rig rig(source);
        rig.core.run(rig.core.cycle() + 2);
        INFO(source);
        REQUIRE(rig.log.size() == 1);
        CHECK(rig.log[0] == "reset " + name);
        CHECK((rig.core.read_data(0x740) & bit) == bit);
        CHECK(rig.w(15) == 0x0800);
        CHECK(rig.w(3) == 0);
    };
    cause("        reset\n", 1u << 6, "RESET instruction");
    cause("        .pword 0x3f1234\n", 1u << 14, "illegal opcode or uninitialised W register");
    cause("        mov [w5], w0\n", 1u << 14, "illegal opcode or uninitialised W register");
    cause("        mov w0, [w6++]\n", 1u << 14, "illegal opcode or uninitialised W register");
    Rig rig("        mov #5, w5\n        reset\n");
    CHECK((rig.data(0x740) & 0x0003) == 3);  // power-on: POR and BOR
    rig.core.write_data(0x740, 0);
    rig.core.reset(ResetCause::Mclr);
    CHECK(rig.data(0x740) == 1u << 7);
}

TEST_CASE("debugger break words run as NOP and are reported once") {
    Rig rig("        .pword 0xda4000\n        .pword 0xdac000\n        .pword 0xda4000\nend:    bra end\n");
    int told = 0;
    rig.core.observer().on_warning = [&](std::string_view, std::uint32_t) { ++told; };
    CHECK(rig.cycles_to("end") == 3);
    CHECK(told == 2);
}
