// What single vectors cannot show: cycles across instructions, hardware loops under interrupts, pointer
// modes, the PSV window, tables, self-programming, power saving and the watchdog.

#include "tests/dspic/rig.h"

#include <catch2/catch.hpp>

using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {
constexpr int kT1 = 3;
constexpr std::uint16_t kRcon = 0x740, kNvmcon = 0x760, kSr = 0x042, kCorcon = 0x044;
}  // namespace

TEST_CASE("a pointer written by the instruction before stalls a source by one cycle") {
    const auto cycles = [](const std::string& pair) {
        Rig rig("        mov #0x1000, w15\n        mov #0x1200, w1\n        mov #0x1300, w2\n        "
                "nop\nhere:\n" +
                pair + "end:    bra end\n");
        REQUIRE(rig.run_to("here"));
        return rig.cycles_to("end");
    };
    // The manual's table: previous destination, present source, stall.
    CHECK(cycles("        mov w2, w1\n        mov w1, w3\n") == 2);          // direct, direct
    CHECK(cycles("        mov w2, [w1]\n        mov w1, w3\n") == 2);        // indirect, direct
    CHECK(cycles("        mov w2, [w1]\n        mov [w1], w3\n") == 2);      // indirect, indirect
    CHECK(cycles("        mov w2, [w1]\n        mov [w1++], w3\n") == 2);    // indirect, with modify
    CHECK(cycles("        mov w2, [w1++]\n        mov w1, w3\n") == 2);      // with modify, direct
    CHECK(cycles("        mov w2, w1\n        mov [w1], w3\n") == 3);        // direct, indirect
    CHECK(cycles("        mov w2, w1\n        mov [w1++], w3\n") == 3);      // direct, with modify
    CHECK(cycles("        mov w2, [w1++]\n        mov [w1], w3\n") == 3);    // with modify, indirect
    CHECK(cycles("        mov w2, [w1++]\n        mov [w1++], w3\n") == 3);  // with modify, with modify
    CHECK(cycles("        mov w2, 0x0002\n        mov [w1], w3\n") == 3);    // through the address of W1
    CHECK(cycles("        mov w2, w1\n        mov w3, [w1]\n") == 2);        // a destination never stalls
    CHECK(cycles("        mov w2, w1\n        nop\n        mov [w1], w3\n") == 3);  // only the next one
}

TEST_CASE("branches, skips and returns take their cycles") {
    const auto cycles = [](const std::string& text) {
        Rig rig("        mov #0x1000, w15\n        clr w0\n        cp0 w0\n        nop\nhere:\n" + text +
                "end:    bra end\nsub:    return\n");
        REQUIRE(rig.run_to("here"));
        return rig.cycles_to("end");
    };
    CHECK(cycles("        bra nz, end\n") == 1);
    CHECK(cycles("        bra z, end\n        nop\n") == 2);
    CHECK(cycles("        btsc w0, #1\n        nop\n        nop\n") == 3);
    CHECK(cycles("        btss w0, #1\n        nop\n        nop\n") == 3);
    CHECK(cycles("        btsc w0, #1\n        goto end\n") == 3);
    CHECK(cycles("        btss w0, #1\n        goto end\n") == 1 + 2);
    CHECK(cycles("        rcall sub\n") == 2 + 3);
    CHECK(cycles("        call sub\n") == 2 + 3);
    CHECK(cycles("        repeat #9\n        nop\n") == 1 + 10);
}

TEST_CASE("REPEAT resumes after an interrupt, and DO loops nest twice") {
    Rig rig(R"(
        mov     #0x1000, w15
        bset    0x8c, #3
        clr     w1
        clr     w2
here:   repeat  #99
        inc     w1, w1
        do      #3, outer
        do      #4, inner
        nop
inner:  inc     w2, w2
outer:  inc     w3, w3
end:    bra     end
isr:    bclr    0x84, #3
        inc     w4, w4
        retfie
)");
    rig.vector(kTrapVectors + kT1, "isr");
    REQUIRE(rig.run_to("here"));
    Raiser t1(rig, kT1);
    t1.at(rig.core.cycle() + 30);
    REQUIRE(rig.run_to("end"));
    CHECK(rig.w(1) == 100);
    CHECK(rig.w(2) == 20);
    CHECK(rig.w(3) == 4);
    CHECK(rig.w(4) == 1);
    CHECK((rig.data(kSr) & (sr::DA | sr::RA)) == 0);
    CHECK((rig.data(kCorcon) & corcon::DL) == 0);
}

TEST_CASE("EDT ends a DO loop after the present iteration") {
    Rig rig(
        "        clr w1\n        do #99, last\n        inc w1, w1\n        cp w1, #7\n        bra nz, next\n"
        "        bset 0x44, #11\nnext:   nop\n        nop\nlast:   nop\nend:    bra end\n");
    REQUIRE(rig.run_to("end"));
    CHECK(rig.w(1) == 7);
}

TEST_CASE("a divide gives the same under interrupts that divide themselves") {
    Rig rig(R"(
        mov     #0x1000, w15
        bset    0x8c, #3
        mov     #1000, w4
        mov     #7, w5
        mov     #60000, w7
        mov     #13, w8
here:   repeat  #17
        div.uw  w4, w5
end:    bra     end
isr:    push.d  w0
        push    0x36
        bclr    0x84, #3
        repeat  #17
        div.uw  w7, w8
        mov     w0, w9
        pop     0x36
        pop.d   w0
        retfie
)");
    rig.vector(kTrapVectors + kT1, "isr");
    REQUIRE(rig.run_to("here"));
    Raiser t1(rig, kT1);
    t1.at(rig.core.cycle() + 8);
    REQUIRE(rig.run_to("end"));
    CHECK(rig.w(0) == 142);
    CHECK(rig.w(1) == 6);
    CHECK(rig.w(9) == 60000 / 13);
}

TEST_CASE("modulo addressing: the manual's example") {
    Rig rig(R"(
        mov     #0x1100, w0
        mov     w0, 0x48            ; XMODSRT
        mov     #0x1163, w0
        mov     w0, 0x4a            ; XMODEND
        mov     #0x8001, w0
        mov     w0, 0x46            ; MODCON: W1, X unit
        mov     #0x0000, w0
        mov     #0x1100, w1
        do      #49, fill
        nop
fill:   mov     w0, [w1++]
        mov     w1, w2
        dec2    w1, w3
        mov     [--w1], w4
end:    bra     end
)");
    REQUIRE(rig.run_to("end"));
    CHECK(rig.w(2) == 0x1100);  // wrapped after 50 words
    CHECK(rig.w(1) == 0x1162);  // and back
}

TEST_CASE("bit-reversed addressing walks a buffer of 16 words in FFT order") {
    std::string source = "        mov #0x1200, w1\n        mov #0x8008, w0\n        mov w0, 0x50\n"
                         "        mov #0x01ff, w0\n        mov w0, 0x46\n        nop\n";
    for (int i = 0; i < 16; ++i)
        source += "        mov #" + std::to_string(i + 100) + ", w2\n        mov w2, [w1++]\n";
    Rig rig(source + "end:    bra end\n");
    REQUIRE(rig.run_to("end"));
    const int order[16] = {0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15};
    for (int i = 0; i < 16; ++i)
        CHECK(rig.data(static_cast<std::uint16_t>(0x1200 + 2 * order[i])) == i + 100);
}

TEST_CASE("the PSV window shows the low words of flash, for its extra cycles") {
    Rig rig(R"(
        mov     #0x1000, w15
        bset    0x44, #2            ; PSV
        mov     #0, w0
        mov     w0, 0x34            ; PSVPAG
        mov     #0x9000, w1
        mov     #0, w2
        nop
here:   mov     [w1], w3            ; 1 + 1
two:    add     w2, [w1++], w4      ; 1 + 2
three:  mov.b   [w1], w5
four:   repeat  #9
        add     w2, [w1], w6        ; 10 + 2 + 2
end:    bra     end
        .org    0x1000
        .pword  0x123456, 0xabcdef
)");
    REQUIRE(rig.run_to("here"));
    CHECK(rig.cycles_to("two") == 2);
    CHECK(rig.cycles_to("three") == 3);
    CHECK(rig.cycles_to("four") == 2);
    CHECK(rig.cycles_to("end") == 1 + 10 + 4);
    CHECK(rig.w(3) == 0x3456);
    CHECK(rig.w(4) == 0x3456);
    CHECK((rig.w(5) & 0xFF) == 0xEF);
    CHECK(rig.w(6) == 0xCDEF);
}

TEST_CASE("flash row erase and program, EEPROM word write, with the key and not without") {
    Rig rig(R"(
        mov     #0x0001, w0
        mov     w0, 0x32            ; TBLPAG
        mov     #0x2000, w1
        mov     #0x1234, w2
        mov     #0x0056, w3
        tblwtl  w2, [w1]
        tblwth  w3, [w1]
        mov     #0x4041, w0
        rcall   go
        tblwtl  w2, [w1]
        tblwth  w3, [w1]
        mov     #0x4001, w0
        rcall   go
program_done:
        tblrdl  [w1], w4
        tblrdh  [w1], w5
        mov     #0x7F, w0
        mov     w0, 0x32
        mov     #0xF010, w1
        tblwtl  w2, [w1]
        mov     #0x4004, w0
        rcall   go
wait:   btsc    0x760, #15
        bra     wait
        tblrdl  [w1], w6
        mov     #0x4004, w0
        tblwtl  w3, [w1]
        mov     w0, 0x760
        bset    0x760, #15           ; no key
        tblrdl  [w1], w7
end:    bra     end
go:     mov     w0, 0x760
        mov     #0x55, w8
        mov     w8, 0x766
        mov     #0xaa, w8
        mov     w8, 0x766
        bset    0x760, #15
        nop
        return
)");
    rig.core.set_w(15, 0x1000);
    rig.core.poke_program(0x12000, 0x000000);
    const Cycle start = rig.core.cycle();
    REQUIRE(rig.run_to("program_done"));
    CHECK(rig.core.cycle() - start > 2 * 29'000);  // the CPU stood still for both
    REQUIRE(rig.run_to("end"));
    CHECK(rig.w(4) == 0x1234);
    CHECK(rig.w(5) == 0x0056);
    CHECK(rig.w(6) == 0x1234);
    CHECK(rig.w(7) == 0x1234);
    CHECK(rig.core.program(0x12002) == 0xFFFFFF);
    CHECK(rig.interrupts.flag(12));
    CHECK((rig.data(kNvmcon) & 0x8000) == 0);
}

TEST_CASE("self-modified code is decoded anew") {
    Rig rig("here:   mov #1, w0\n        bra here\n");
    rig.core.run(rig.core.cycle() + 30);
    CHECK(rig.w(0) == 1);
    rig.core.poke_program(0x200, 0x200020);  // mov #2, w0
    rig.core.run(rig.core.cycle() + 30);
    CHECK(rig.w(0) == 2);
}

TEST_CASE("Idle ends with an enabled interrupt: taken above the CPU's level, passed below it") {
    for (const int level : {0, 7}) {
        Rig rig("        mov #0x1000, w15\n        bset 0x8c, #3\n        mov w1, 0x42\nhere:   pwrsav #1\n"
                "next:   inc w2, w2\nloop:   bra loop\nisr:    inc w3, w3\n        bclr 0x84, #3\n        "
                "retfie\n");
        rig.vector(kTrapVectors + kT1, "isr");
        rig.core.set_w(1, static_cast<std::uint16_t>(level << 5));
        PowerMode seen = PowerMode::Run;
        rig.core.set_power_hook([&](PowerMode mode) { seen = mode; });
        REQUIRE(rig.run_to("here"));
        Raiser t1(rig, kT1);
        const Cycle wake = rig.core.cycle() + 500;
        t1.at(wake);
        rig.core.run(wake);
        CHECK(seen == PowerMode::Idle);
        CHECK(rig.w(2) == 0);
        REQUIRE(rig.run_to("loop"));
        CHECK(rig.w(3) == (level == 0 ? 1 : 0));
        CHECK(rig.w(2) == 1);
        CHECK(seen == PowerMode::Run);
        CHECK((rig.data(kRcon) & rcon::IDLE) != 0);
    }
}

TEST_CASE("the watchdog resets, CLRWDT holds it off, Sleep wakes with it") {
    constexpr double kRate = 1e6;  // 2 ms at the shortest setting: 2000 cycles
    const std::string spin = "        mov #0x1000, w15\n        bset 0x740, #5\nloop:   bra loop\n";
    Rig rig(spin);
    rig.core.poke_program(0xF80002, 0x0000);
    rig.core.set_cycle_rate(kRate);
    rig.core.run(rig.core.cycle() + 1900);
    CHECK(rig.log.empty());
    rig.core.run(rig.core.cycle() + 200);
    REQUIRE(rig.log.size() == 1);
    CHECK(rig.log[0] == "reset watchdog");
    CHECK((rig.data(kRcon) & rcon::WDTO) != 0);

    Rig fed("        bset 0x740, #5\nloop:   clrwdt\n        bra loop\n");
    fed.core.poke_program(0xF80002, 0x0000);
    fed.core.set_cycle_rate(kRate);
    fed.core.run(20'000);
    CHECK(fed.log.empty());

    Rig asleep("        bset 0x740, #5\n        pwrsav #0\n        mov 0x740, w2\n        inc w1, w1\n"
               "loop:   clrwdt\n        bra loop\n");
    asleep.core.poke_program(0xF80002, 0x0000);
    asleep.core.set_cycle_rate(kRate);
    asleep.core.run(1900);
    CHECK(asleep.w(1) == 0);
    asleep.core.run(2100);
    CHECK(asleep.w(1) == 1);
    CHECK(asleep.log.empty());
    CHECK((asleep.w(2) & (rcon::WDTO | rcon::SLEEP)) == (rcon::WDTO | rcon::SLEEP));
    CHECK((asleep.data(kRcon) & (rcon::WDTO | rcon::SLEEP)) == rcon::WDTO);  // CLRWDT clears SLEEP
}

TEST_CASE("core registers: what software may write") {
    Rig rig("end:    bra end\n");
    rig.core.write_data(kSr, 0xFFFF);
    CHECK(rig.data(kSr) == (sr::C | sr::Z | sr::OV | sr::N | sr::DC | sr::IPL));
    rig.core.write_data(kCorcon, 0xFFFF);
    CHECK(rig.data(kCorcon) == (0x1FFF & ~(corcon::DL | corcon::EDT | corcon::IPL3)));
    rig.core.write_data(0x026, 0x0080);  // ACCAU
    CHECK(rig.data(0x026) == 0xFF80);
    rig.core.write_data(0x01E, 0x1235);
    CHECK(rig.w(15) == 0x1234);
    rig.core.write_data(0x052, 100);  // DISICNT is 0: no effect
    CHECK(rig.data(0x052) == 0);
    CHECK(rig.data(0x02E) == rig.core.pc());
}

TEST_CASE("stops end a run before the instruction, and a run in small grants is the same run") {
    const std::string source = "        mov #0x1000, w15\nloop:   inc w1, w1\n        mov w1, [w15]\n"
                               "        mov [w15], w2\n        bra loop\n";
    Rig whole(source), cut(source);
    whole.core.run(5000);
    for (Cycle until = cut.core.cycle(); until <= 5000; until += 1)
        cut.core.run(until);
    CHECK(whole.core.cycle() == cut.core.cycle());
    CHECK(whole.core.pc() == cut.core.pc());
    CHECK(whole.w(1) == cut.w(1));
    CHECK(whole.core.instructions() == cut.core.instructions());
    const std::uint32_t at[] = {cut.program.symbol("loop")};
    cut.core.set_stops(at);
    REQUIRE(cut.core.run(cut.core.cycle() + 100) == Core::Outcome::Stopped);
    for (int i = 0; i < 3; ++i) {
        const std::uint16_t before = cut.w(1);
        const Cycle start = cut.core.cycle();
        REQUIRE(cut.core.run(start + 100) == Core::Outcome::Stopped);
        CHECK(cut.core.pc() == at[0]);
        CHECK(cut.w(1) == before + 1);
        CHECK(cut.core.cycle() == start + 5);
    }
}
