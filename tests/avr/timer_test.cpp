// The timers as a program sees them, cycle for cycle as the data sheet draws it.

#include "tests/avr/rig.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::avr;
using test::Rig;

namespace {

/// Distances between neighbours.
std::vector<Cycle> steps(const std::vector<Cycle>& cycles, std::size_t from = 0) {
    std::vector<Cycle> result;
    for (std::size_t i = from + 1; i < cycles.size(); ++i)
        result.push_back(cycles[i] - cycles[i - 1]);
    return result;
}
void all_are(const std::vector<Cycle>& values, Cycle value) {
    REQUIRE(values.size() > 3);
    for (const Cycle v : values)
        CHECK(v == value);
}

}  // namespace

TEST_CASE("TCNT counts the clock, an IN and an LDS see it one clock apart") {
    Rig rig(R"(
        ldi r16, 1
        out TCCR0B, r16     ; clock 1
        in  r17, TCNT0      ; clock 2
        nop
        in  r18, TCNT0      ; clock 4
        lds r19, 0x46       ; clocks 5, 6: reads in the second
        sts 0x100, r17
        sts 0x101, r18
        sts 0x102, r19
loop:   rjmp loop
)");
    rig.run(100);
    CHECK(rig.ram(0x101) - rig.ram(0x100) == 2);
    CHECK(rig.ram(0x102) - rig.ram(0x101) == 2);
}

TEST_CASE("the prescaler runs on whoever listens: the first tick comes at its next edge") {
    Rig rig(R"(
        ldi r16, 3          ; /64
        .org 60             ; 30 words of nops (erased flash runs as such): started in clock 30
        out TCCR0B, r16
wait:   in  r17, TCNT0
        tst r17
        breq wait
        sbi DDRA, 0
        sbi PORTA, 0
loop:   rjmp loop
)");
    rig.run(200);
    const auto edges = rig.changes({PortLetter::A, 0});
    REQUIRE(edges.size() == 1);
    CHECK(edges[0] > 64);
    CHECK(edges[0] < 64 + 4 + 8);
}

TEST_CASE(
    "a write to TCNT leaves the prescaler's phase alone: timer 2 as the infra-red transmitter uses it") {
    Rig rig(R"(
        jmp start
        .org 0x2c           ; TIMER2_OVF
        ldi r16, 210
        sts TCNT2, r16
        sbi PINA, 0
        reti
start:  sbi DDRA, 0
        ldi r16, 4          ; /64
        sts TCCR2B, r16
        ldi r16, 1
        sts TIMSK2, r16
        sei
loop:   rjmp loop
)");
    rig.run(60000);
    const auto gaps = steps(rig.changes({PortLetter::A, 0}), 1);
    // 46 counts of 64 clocks; the edge itself moves with the instruction in progress, by one clock.
    REQUIRE(gaps.size() > 10);
    Cycle sum = 0;
    for (const Cycle gap : gaps) {
        CHECK(gap >= 46 * 64 - 1);
        CHECK(gap <= 46 * 64 + 1);
        sum += gap;
    }
    CHECK(static_cast<double>(sum) / static_cast<double>(gaps.size()) == Approx(46 * 64).margin(0.1));
}

TEST_CASE("CTC: OC0A toggles every OCR0A + 1 counts, exactly") {
    Rig rig(R"(
        sbi DDRB, 3
        ldi r16, 99
        out OCR0A, r16
        ldi r16, 0x42       ; toggle OC0A, CTC
        out TCCR0A, r16
        ldi r16, 2          ; /8
        out TCCR0B, r16
loop:   rjmp loop
)");
    rig.run(20000);
    const auto edges = rig.changes({PortLetter::B, 3});
    all_are(steps(edges), 100 * 8);
    CHECK(edges[0] % 8 == 0);
    CHECK(rig.chip.peek("TIFR0") == 0x06);  // OCF0A, and OCF0B at 0; never TOV0
}

TEST_CASE("fast PWM: OCR + 1 counts high, a new compare value waits for BOTTOM") {
    Rig rig(R"(
        sbi DDRD, 7
        ldi r16, 63
        sts OCR2A, r16
        ldi r16, 0x83       ; clear on match, set at BOTTOM
        sts TCCR2A, r16
        ldi r16, 1
        sts TCCR2B, r16
        ldi r17, 255
        ldi r18, 3
wait:   dec r17
        brne wait
        dec r18
        brne wait
        ldi r16, 199
        sts OCR2A, r16
loop:   rjmp loop
)");
    rig.run(6000);
    const auto edges = rig.changes({PortLetter::D, 7});
    REQUIRE(edges.size() > 20);
    std::size_t changed = 0;
    for (std::size_t i = 1; i + 2 < edges.size(); i += 1) {
        const bool rises = i % 2 == 0;
        if (!rises) continue;
        CHECK(edges[i + 2] - edges[i] == 256);
        const Cycle high = edges[i + 1] - edges[i];
        CHECK((high == 64 || high == 200));
        if (high == 200) ++changed;
    }
    CHECK(changed > 3);
    CHECK(edges[1] - edges[0] != 0);
}

TEST_CASE("fast PWM: a compare value at the top makes a steady level") {
    for (const auto& [control, changes] :
         {std::pair{0x83, 1u}, {0xC3, 0u}}) {  // high from the first BOTTOM on; low
        Rig rig(R"(
        sbi DDRD, 7
        ldi r16, 255
        sts OCR2A, r16
        ldi r16, )" +
                std::to_string(control) + R"(
        sts TCCR2A, r16
        ldi r16, 1
        sts TCCR2B, r16
loop:   rjmp loop
)");
        rig.run(5000);
        CHECK(rig.changes({PortLetter::D, 7}).size() == changes);
    }
}

TEST_CASE("phase correct PWM: 510 counts a period, 2 OCR high, symmetric") {
    Rig rig(R"(
        sbi DDRB, 3
        ldi r16, 40
        out OCR0A, r16
        ldi r16, 0x81
        out TCCR0A, r16
        ldi r16, 1
        out TCCR0B, r16
loop:   rjmp loop
)");
    rig.run(8000);
    const auto edges = rig.changes({PortLetter::B, 3});
    REQUIRE(edges.size() > 10);
    for (std::size_t i = 2; i + 2 < edges.size(); i += 2) {
        CHECK(edges[i + 2] - edges[i] == 510);
        CHECK(edges[i + 1] - edges[i] == 80);
    }
}

TEST_CASE("16-bit registers move whole through TEMP") {
    Rig rig(R"(
        ldi r16, 0x12
        ldi r17, 0x34
        sts TCNT1H, r16     ; into TEMP
        sts TCNT1L, r17     ; all 16 bits
        ldi r16, 0xAB
        sts OCR1AH, r16
        sts OCR1AL, r17
        lds r18, TCNT1L     ; the high byte into TEMP
        ldi r16, 0x55
        lds r19, OCR1AH     ; without TEMP
        lds r20, TCNT1H
        sts 0x100, r18
        sts 0x101, r19
        sts 0x102, r20
        ldi r16, 1
        sts TCCR1B, r16
        lds r21, TCNT1L
        lds r22, TCNT1H
        lds r23, TCNT1L
        sts 0x103, r21
        sts 0x104, r22
        sts 0x105, r23
loop:   rjmp loop
)");
    rig.run(200);
    CHECK(rig.ram(0x100) == 0x34);
    CHECK(rig.ram(0x101) == 0xAB);
    CHECK(rig.ram(0x102) == 0x12);
    CHECK(rig.ram(0x104) == 0x12);
    CHECK(rig.ram(0x105) - rig.ram(0x103) == 4);
}

TEST_CASE(
    "input capture stores the count at the edge that ICES1 selects, the noise canceler takes four clocks") {
    for (const bool canceler : {false, true}) {
        const std::string select = canceler ? "0xC1" : "0x41";  // rising edge, clock / 1
        // The STS writes in clock 2; the timer counts from the second clock after it on.
        Rig reader(
            "        ldi r16, " + select +
            "\n        sts TCCR1B, r16\n        .org 0x200\n"
            "loop:   in r20, TIFR1\n        sbrs r20, 5\n        rjmp loop\n        lds r21, ICR1L\n"
            "        lds r22, ICR1H\n        sts 0x100, r21\n        sts 0x101, r22\nend:    rjmp end\n");
        reader.run(20);
        reader.set_pin({PortLetter::D, 6}, false);
        reader.run(1000);
        reader.set_pin({PortLetter::D, 6}, true);
        const auto at = reader.chip.clock().first_cycle_at(reader.chip.now());
        reader.run(1200);
        const int captured = reader.ram(0x100) | reader.ram(0x101) << 8;
        CHECK(captured == static_cast<int>(at) - 3 + (canceler ? 4 : 0));
    }
}

TEST_CASE("an overflow interrupt is entered 4 clocks behind the instruction in progress") {
    Rig rig(R"(
        jmp start
        .org 0x48           ; TIMER0_OVF
        sbi PINA, 0
        reti
start:  sbi DDRA, 0
        ldi r16, 1
        sts TIMSK0, r16
        out TCCR0B, r16     ; started in the clock of this OUT
        sei
        .org 0x400
loop:   rjmp loop
)");
    rig.run(2000);
    const auto edges = rig.changes({PortLetter::A, 0});
    // The first overflow finds an instruction of one clock, later ones the same clock of an RJMP.
    all_are(steps(edges, 1), 256);
    CHECK(edges.at(1) - edges.at(0) - 256 <= 1);
}
