// Every pin of change notification and of the external interrupts, and waking by them.

#include "emu/dspic/machine/interrupts.h"
#include "emu/dspic/machine/sfr_space.h"
#include "tests/dspic/chip30_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

constexpr int kCn = 15;
const std::string kNothing = "        .org 0x200\nmain: setm ADPCFG\nready:  bra ready\n";

/// Port letter and bit, as the data sheet's pin diagram names CN0 to CN23.
const char* const kChangePins[] = {"C14", "C13", "B0", "B1",  "B2",  "B3",  "B4", "B5",
                                   "G6",  "G7",  "G8", "G9",  "B15", "D4",  "D5", "D6",
                                   "D7",  "F4",  "F5", "D13", "D14", "D15", "A6", "A7"};

}  // namespace

TEST_CASE("CN0 to CN23 each see their pin and no other, both edges count (fact sheet 9)") {
    for (int cn = 0; cn < 24; ++cn) {
        CAPTURE(cn);
        Bench30 bench(kNothing);
        bench.go(100);
        Chip::Inside inside = bench.chip.inside();
        inside.sfr.write(cn < 16 ? 0xC0 : 0xC2, static_cast<std::uint16_t>(1u << (cn % 16)), 0xFFFF);
        Cycle at = 1000;
        for (int other = 0; other < 24; ++other, at += 100) {
            const auto port = static_cast<PortLetter>(kChangePins[other][0] - 'A');
            const int bit = std::stoi(kChangePins[other] + 1);
            for (const bool level : {true, false}) {
                bench.set(port, bit, level, at + (level ? 0 : 50));
                CHECK(inside.interrupts.flag(kCn) == (level && other == cn));
                // Back to the level of the last read: no difference, no flag, until the port is read.
                if (inside.interrupts.flag(kCn)) inside.interrupts.clear(kCn);
            }
        }
    }
}

TEST_CASE("a change wakes from Sleep (fact sheet 9)") {
    Bench30 bench(R"(
        .org 0x200
main:   mov #0x0900, w15
        setm ADPCFG
        mov #0x0001, w0
        mov w0, CNEN1
        mov PORTC, w0
        bset IEC0, #15
        mov #0xe0, w0
        mov w0, SR
sleep:  pwrsav #0
woken:  bra woken
)");
    bench.run_to("sleep");
    bench.set(PortLetter::C, 14, true, 20'000);
    CHECK(bench.run_to("woken") > 20'000);
}

TEST_CASE("INT0 to INT4: the pin, the edge that INTCON2 chooses") {
    struct Input {
        PortLetter port;
        int bit;
        int irq;
    };
    const Input inputs[] = {{PortLetter::F, 6, 0},
                            {PortLetter::A, 12, 16},
                            {PortLetter::A, 13, 23},
                            {PortLetter::A, 14, 36},
                            {PortLetter::A, 15, 37}};
    for (int falling = 0; falling < 2; ++falling)
        for (int n = 0; n < 5; ++n) {
            CAPTURE(falling, n);
            Bench30 bench(kNothing);
            bench.go(100);
            Chip::Inside inside = bench.chip.inside();
            inside.sfr.write(0x82, static_cast<std::uint16_t>(falling << n), 0xFFFF);
            const Input& input = inputs[n];
            bench.set(input.port, input.bit, true, 1000);
            for (int m = 0; m < 5; ++m)
                CHECK(inside.interrupts.flag(inputs[m].irq) == (m == n && !falling));
            inside.interrupts.clear(input.irq);
            bench.set(input.port, input.bit, false, 1100);
            for (int m = 0; m < 5; ++m)
                CHECK(inside.interrupts.flag(inputs[m].irq) == (m == n && falling));
        }
}
