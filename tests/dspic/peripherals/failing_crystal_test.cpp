// The crystal stops: fail-safe clock monitor, its trap, and a part without it. Times of waking from Sleep.

#include "emu/dspic/machine/sfr_space.h"
#include "tests/dspic/chip30_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

const std::string kProgram = R"(
        .org 0x06
        .pword trapped
        .org 0x1a
        .pword timer
        .org 0x200
main:   mov #0x0900, w15
        mov #0x27f0, w0
        mov w0, SPLIM
        mov #0x3fff, w0
        mov w0, PR1
        mov #0x8000, w0
        mov w0, T1CON
ready:  bra ready
trapped: mov OSCCON, w1
        mov w1, 0x1000
        mov #0x46, w2                   ; CF is cleared behind the keys
        mov #0x57, w3
        mov #OSCCON, w4
        clr w5
        mov.b w2, [w4]
        mov.b w3, [w4]
        mov.b w5, [w4]
        bclr INTCON1, #1
        retfie
timer:  retfie
)";

}  // namespace

TEST_CASE("with the fail-safe monitor the chip goes on with its RC oscillator, CF and a trap (DS70046 7.9)") {
    Bench30 bench(kProgram, {}, 0x3FE6);  // FCKSM = 00
    bench.go(10'000);
    CHECK(bench.chip.clock().hertz() == Approx(14'745'600.0));
    bench.chip.stop_crystal();
    bench.go(11'000);
    CHECK(bench.chip.clock().hertz() == Approx(7'370'000.0 / 4));
    REQUIRE(bench.chip.report().traps.size() == 1);
    CHECK(bench.chip.report().traps[0].name == "OscillatorFail");
    CHECK((bench.word(0x1000) & 0x7028) == 0x1008);  // COSC = FRC, CF, no LOCK
    CHECK((bench.reg("OSCCON") & 8) == 0);
    CHECK((bench.reg("INTCON1") & 2) == 0);
    CHECK(bench.chip.pc() == bench.symbols.at("ready"));
}

TEST_CASE("without the monitor the chip stands still, and the report has it") {
    Bench30 bench(kProgram, {}, 0xFFE6);
    bench.go(10'000);
    bench.chip.stop_crystal();
    const std::uint64_t before = bench.chip.report().instructions;
    bench.go(200'000);
    CHECK(bench.chip.report().instructions <= before + 2);
    REQUIRE(bench.chip.report().warnings.size() == 1);
    CHECK(bench.chip.report().warnings[0].text == "its crystal stopped, and no monitor watches it");
}

TEST_CASE("an RC oscillator does not mind") {
    Bench30 bench(kProgram, {}, 0xF9E6);  // FRC
    bench.go(1000);
    bench.chip.stop_crystal();
    bench.go(20'000);
    CHECK(bench.chip.report().traps.empty());
    CHECK(bench.chip.report().instructions > 5000);
}

TEST_CASE("from Sleep to the first instruction: 10 us, the crystal's 1024 periods, the PLL, the monitor") {
    struct Case {
        std::uint16_t fosc;
        double seconds;
    };
    constexpr double kCrystal = 7'372'800.0;
    for (const Case& one : {Case{0xFFE6, 30e-6 + 1024 / kCrystal}, Case{0x3FE6, 130e-6 + 1024 / kCrystal},
                            Case{0xFBE4, 10e-6 + 1024 / kCrystal}, Case{0xF9E6, 10e-6}}) {
        CAPTURE(one.fosc);
        Bench30 bench(R"(
        .org 0x200
main:   mov #0x0900, w15
        bset IEC0, #0                   ; INT0, which a rising edge of RF6 raises
        mov #0xe0, w0
        mov w0, SR
sleep:  pwrsav #0
woken:  bra woken
)",
                      {}, one.fosc);
        bench.run_to("sleep");
        bench.set(PortLetter::F, 6, true, 10'000);
        const Cycle woken = bench.run_to("woken");
        const double delay = one.seconds * bench.chip.clock().hertz();
        CHECK(static_cast<double>(woken) >= 10'000 + delay - 1);
        CHECK(static_cast<double>(woken) <= 10'000 + delay + 4);
    }
}

TEST_CASE("device and revision are read by table reads (fact sheet memory_map)") {
    Bench30 bench(R"(
        .org 0x200
main:   mov #0xff, w0
        mov w0, TBLPAG
        clr w1
        tblrdl [w1++], w2
        tblrdl [w1], w3
        mov w2, 0x1000
        mov w3, 0x1002
        mov #0xf8, w0
        mov w0, TBLPAG
        clr w1
        tblrdl [w1], w2
        mov w2, 0x1004
ready:  bra ready
)",
                  {{0xF80000, 0xC703}});
    bench.run_to("ready");
    CHECK(bench.word(0x1000) == 0x02C3);
    CHECK(bench.word(0x1002) == 0x1040);
    CHECK(bench.word(0x1004) == 0xC703);
}
