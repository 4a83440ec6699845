// Watchdog, brown-out, sleep and timed sequences where a careless model is kinder than the chip. Sources:
// data sheet 8272, "Watchdog Timer", "Power Management and Sleep Modes" (BOD disable, table 10-1), "Brown-out
// Detection", "Idle Mode", "ADC Noise Canceler", "Moving Interrupts Between Application and Boot Space",
// "EEPROM Control Register".

#include "base/random.h"
#include "tests/avr/rig.h"

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <algorithm>

using namespace puckloop;
using namespace puckloop::avr;
using test::Rig;
using P = PortLetter;

namespace {

constexpr Cycle kShortest = 256'000;  ///< cycles of 16 MHz in the watchdog's 16 ms
constexpr std::uint8_t kBrownOut4V3 = 0xFC;

std::vector<Cycle> watchdog_resets(const Rig& rig) {
    std::vector<Cycle> cycles;
    for (const ResetRecord& reset : rig.chip.report().resets)
        if (reset.cause == ResetCause::Watchdog) cycles.push_back(reset.cycle);
    return cycles;
}

/// Interrupt and reset mode from the mark at PA1 on; the routine toggles PA0. `behind`: what comes then, with
/// r20 set by each interrupt.
std::string both_modes(unsigned select, const std::string& behind) {
    return fmt::format(R"(
        jmp  start
        .org 0x20
        sbi  PINA, 0
        ldi  r20, 1
        reti
start:  ldi  r16, 0
        out  MCUSR, r16
        ldi  r16, 3
        out  DDRA, r16
        ldi  r16, 0x18
        ldi  r17, {}
        wdr
        sts  WDTCSR, r16
        sts  WDTCSR, r17
        sbi  PINA, 1
{}
end:    rjmp end
)",
                       0x48 | select, behind);
}

/// Cycles from the end of a reset by the supply to the first instruction.
Cycle start_up(const Rig& rig) {
    const StartUp time = rig.chip.fuses().reset_start_up();
    return time.clocks + static_cast<Cycle>(time.seconds * rig.chip.clock().hertz() + 0.5);
}

}  // namespace

TEST_CASE("the watchdog in both modes resets at the second time-out, served or not, unless it is set again") {
    RandomStream random(20261123, "watchdog");
    const auto select = static_cast<unsigned>(random.below(3));
    const Cycle period = kShortest << select;
    const auto near = [](Cycle at, Cycle wanted) { return at + 12 > wanted && at < wanted + 12; };
    for (const bool served : {false, true}) {
        Rig rig(both_modes(select, served ? "sei" : "cli"));
        rig.run(5 * period / 2);
        const auto interrupts = rig.changes({P::A, 0});
        const Cycle begin = rig.changes({P::A, 1}).at(0);
        CHECK(interrupts.size() == (served ? 2 : 0));  // the reset takes the pin back
        if (served) CHECK(near(interrupts[0], begin + period));
        const auto resets = watchdog_resets(rig);
        REQUIRE(resets.size() == 1);
        CHECK(near(resets[0], begin + 2 * period));
    }
    // Set again by the main program at any time in between, it interrupts for ever, exactly each period.
    Rig rig(both_modes(select, fmt::format(R"(
        sei
main:   tst  r20
        breq main
        clr  r20
        ldi  r24, lo8({0})
        ldi  r25, hi8({0})
wait:   sbiw r24, 1
        brne wait
        lds  r16, WDTCSR
        ori  r16, 0x40
        sts  WDTCSR, r16
        rjmp main
)",
                                           1000 + random.below(50'000))));
    rig.run(7 * period);
    CHECK(watchdog_resets(rig).empty());
    const auto interrupts = rig.changes({P::A, 0});
    REQUIRE(interrupts.size() == 6);
    for (std::size_t i = 1; i < interrupts.size(); ++i)
        CHECK(near(interrupts[i], interrupts[0] + i * period));
}

TEST_CASE("another time-out of the watchdog counts from the last WDR, what is past it is over at once") {
    for (const unsigned turns : {1u, 3u}) {  // of 16.4 ms
        Rig rig(fmt::format(R"(
        jmp  start
        .org 0x20
        sbi  PINA, 0
        reti
start:  ldi  r16, 3
        out  DDRA, r16
        ldi  r16, 0x58
        ldi  r17, 0x43       ; 128 ms
        ldi  r19, 0x41       ; 32 ms
        wdr
        sts  WDTCSR, r16
        sts  WDTCSR, r17
        sbi  PINA, 1
        sei
        ldi  r18, {}
turn:   sbiw r24, 1
        brne turn
        dec  r18
        brne turn
        sts  WDTCSR, r16
        sts  WDTCSR, r19
        sbi  PINA, 1
end:    rjmp end
)",
                            turns));
        rig.run(5 * kShortest);
        const auto marks = rig.changes({P::A, 1});
        REQUIRE(marks.size() == 2);
        const auto interrupts = rig.changes({P::A, 0});
        REQUIRE(!interrupts.empty());
        const Cycle wanted = std::max(marks[0] + 2 * kShortest, marks[1]);
        CHECK(interrupts[0] + 15 > wanted);
        CHECK(interrupts[0] < wanted + 15);
    }
}

TEST_CASE("the brown-out detector may sleep in the deeper modes only, and looks before the program goes on") {
    const auto program = [](unsigned mode) {
        return fmt::format(R"(
        jmp  start
        .org 0x10
        reti
start:  sbi  DDRB, 0
        ldi  r16, 1
        sts  PCICR, r16
        ldi  r16, 2
        sts  PCMSK0, r16
        ldi  r16, {}
        out  SMCR, r16
        ldi  r16, 0x60
        ldi  r17, 0x40
        sei
        out  MCUCR, r16
        out  MCUCR, r17
        sleep
        sbi  PINB, 0
end:    rjmp end
)",
                           1 | mode << 1);
    };
    ChipOptions options;
    options.fuses = {0xE2, 0xD9, kBrownOut4V3, 0xFF};  // 8 MHz, which is there at once
    const auto brown_outs = [](const Rig& rig) {
        const auto resets = rig.chip.report().resets;
        return std::count_if(resets.begin(), resets.end(),
                             [](const ResetRecord& r) { return r.cause == ResetCause::BrownOut; });
    };
    for (const unsigned mode : {0u, 1u, 2u, 3u, 6u, 7u}) {
        INFO("sleep mode " << mode);
        const bool off = mode > 1;
        Rig rig(program(mode), options);
        rig.run(2000);
        REQUIRE(rig.chip.sleeping());
        Rig fine(program(mode), options);
        fine.run(2000);
        fine.set_pin({P::A, 1}, false);
        fine.run(4000);
        const auto awake = fine.changes({P::B, 0});
        REQUIRE(awake.size() == 1);
        const Cycle woken = awake[0] - 2000;  // 60 us of 8 MHz, and the routine
        CHECK(woken >= (off ? 480 : 4));
        CHECK(woken <= (off ? 500 : 30));

        rig.chip.set_supply(4.0);
        rig.run(3000);
        CHECK(brown_outs(rig) == (off ? 0 : 1));
        CHECK(rig.chip.sleeping() == off);
        rig.set_pin({P::A, 1}, false);
        rig.run(10'000);
        CHECK(brown_outs(rig) == 1);
        CHECK(rig.changes({P::B, 0}).empty());
        const std::uint64_t stands = rig.chip.report().instructions;
        rig.chip.external_reset();  // the button does not help
        rig.run(11'000);
        CHECK(rig.chip.report().instructions == stands);
        rig.chip.set_supply(4.4);
        rig.run(12'000 + start_up(rig));
        CHECK(rig.chip.report().instructions > stands);
        CHECK((rig.chip.peek("MCUSR") & 0x04) != 0);
    }
}

TEST_CASE("a chip that is switched on below its brown-out level waits for its supply") {
    ChipOptions options;
    options.fuses.extended = kBrownOut4V3;
    options.avcc = 3.3;
    Rig rig("loop: rjmp loop\n", options);
    rig.run(100'000);
    CHECK(rig.chip.report().instructions == 0);
    rig.chip.set_supply(4.5);
    rig.run(200'000 + start_up(rig));
    CHECK(rig.chip.report().instructions == 50'000);
    CHECK(rig.chip.report().resets.size() == 1);
}

TEST_CASE("idle and ADC noise reduction mode begin a conversion, and its end wakes, other modes do not") {
    RandomStream random(20261123, "idle");
    for (const unsigned mode : {0u, 1u, 2u}) {
        const auto channel = static_cast<unsigned>(random.below(8));
        Rig rig(fmt::format(R"(
        jmp  start
        .org 0x60
        lds  r20, ADCL
        lds  r21, ADCH
        sts  0x100, r20
        sts  0x101, r21
        sbi  PINB, 0
        reti
start:  sbi  DDRB, 0
        ldi  r16, {}
        sts  ADMUX, r16
        ldi  r16, 0x8F
        sts  ADCSRA, r16
        ldi  r16, {}
        out  SMCR, r16
        sei
        sleep
end:    rjmp end
)",
                            0x40 | channel, 1 | mode << 1));
        rig.volts[channel] = 5.0 * random.uniform();
        rig.run(10'000);
        const auto done = rig.changes({P::B, 0});
        if (mode == 2) {
            CHECK(done.empty());
            CHECK(rig.chip.sleeping());
            continue;
        }
        REQUIRE(done.size() == 1);  // one conversion: it is the CPU's halt that begins one
        constexpr Cycle kFirst = Cycle{25} * 128;
        CHECK(done[0] > kFirst);
        CHECK(done[0] < kFirst + 128 + 60);
        CHECK((rig.ram(0x100) | rig.ram(0x101) << 8) == static_cast<int>(rig.volts[channel] / 5.0 * 1024.0));
    }
}

TEST_CASE("no interrupt comes between IVCE and IVSEL") {
    // An overflow of timer 0 is pending; its routine keeps the number of instructions that came before it.
    const auto before_interrupt = [](const std::string& sequence) {
        Rig rig(R"(
        jmp  start
        .org 0x48
        sts  0x100, r20
stay:   rjmp stay
        .org 0x100
start:  ldi  r16, 1
        sts  TIMSK0, r16
        out  TCCR0B, r16
        ldi  r16, 0xF0
        out  TCNT0, r16
        ldi  r16, 1
        ldi  r17, 2
        clr  r20
        ldi  r18, 20
fill:   dec  r18
        brne fill
        sei
)" + sequence + R"(
        inc  r20
        inc  r20
        inc  r20
        inc  r20
        inc  r20
        inc  r20
        inc  r20
        inc  r20
end:    rjmp end
        .org 0x1E048
        sts  0x100, r20
stays:  rjmp stays
)");
        rig.run(1000);
        return static_cast<int>(rig.ram(0x100));
    };
    CHECK(before_interrupt("nop\n") == 0);
    CHECK(before_interrupt("out MCUCR, r16\n") == 4);
    CHECK(before_interrupt("out MCUCR, r16\n out MCUCR, r17\n") == 1);
}

TEST_CASE("the EEPROM's mode stands while a byte is programmed") {
    Rig rig(R"(
        ldi  r16, 4
        ldi  r17, 6
        out  EECR, r16
        out  EECR, r17
        ldi  r16, 0x20
        out  EECR, r16
        in   r18, EECR
        sts  0x100, r18
busy:   sbic EECR, 1
        rjmp busy
        out  EECR, r16
        in   r18, EECR
        sts  0x101, r18
end:    rjmp end
)");
    rig.run(100'000);
    CHECK(rig.ram(0x100) == 0x02);
    CHECK(rig.ram(0x101) == 0x20);
}
