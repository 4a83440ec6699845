// A chip's state: saved at any time, loaded into another chip, it goes on as the original; damaged, it is
// refused.

#include "base/random.h"
#include "base/states/archive.h"
#include "tests/avr/rig.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::avr;
using test::Rig;

namespace {

/// Timers with PWM and capture, a USART, ADC, EEPROM, watchdog and sleep at once.
const char* const kProgram = R"(
        jmp start
        .org 0x48           ; TIMER0_OVF
        lds  r24, 0x200
        inc  r24
        sts  0x200, r24
        sbi  PINC, 0
        reti
        .org 0x60           ; ADC
        lds  r20, ADCL
        lds  r21, ADCH
        sts  UDR0, r20
        reti
start:  ldi  r16, 0xFF
        out  DDRC, r16
        out  DDRB, r16
        out  DDRD, r16
        ldi  r16, 0x83
        out  TCCR0A, r16
        ldi  r16, 2
        out  TCCR0B, r16
        ldi  r16, 1
        sts  TIMSK0, r16
        ldi  r16, 0xA1
        sts  TCCR1A, r16
        ldi  r16, 0x0A
        sts  TCCR1B, r16
        ldi  r16, 0x08
        sts  UCSR0B, r16
        ldi  r16, 12
        sts  UBRR0L, r16
        ldi  r16, 0x40
        sts  ADMUX, r16
        ldi  r16, 0xEF
        sts  ADCSRA, r16
        ldi  r16, 1
        out  SMCR, r16
        sei
loop:   sleep
        lds  r17, 0x200
        out  OCR0A, r17
        sts  OCR1AL, r17
        out  EEARL, r17
        out  EEDR, r17
        sbic EECR, 1
        rjmp loop
        cli
        sbi  EECR, 2
        sbi  EECR, 1
        sei
        wdr
        rjmp loop
)";

/// What has a clock line, and timer 2 with its own: SPI and both USARTs send for ever, each overflow writes a
/// register of the timer.
const char* const kClocked = R"(
        jmp start
        .org 0x2C           ; TIMER2_OVF
        lds  r24, 0x200
        inc  r24
        sts  0x200, r24
        sts  OCR2A, r24
        reti
        .org 0x4C           ; SPI_STC
        in   r25, SPDR
        inc  r25
        out  SPDR, r25
        reti
        .org 0x54           ; USART0_UDRE
        inc  r20
        sts  UDR0, r20
        reti
        .org 0x74           ; USART1_UDRE
        inc  r21
        sts  UDR1, r21
        reti
start:  ldi  r16, 0xBF
        out  DDRB, r16
        ldi  r16, 0xFA
        out  DDRD, r16
        ldi  r16, 0xD6      ; SPI master, /64, CPHA
        out  SPCR, r16
        ldi  r16, 40
        sts  UBRR0L, r16
        ldi  r16, 0x66      ; synchronous, even parity
        sts  UCSR0C, r16
        ldi  r16, 0x38
        sts  UCSR0B, r16
        ldi  r16, 21
        sts  UBRR1L, r16
        ldi  r16, 0xC3      ; SPI master
        sts  UCSR1C, r16
        ldi  r16, 0x38
        sts  UCSR1B, r16
        ldi  r16, 0x20
        sts  ASSR, r16
        ldi  r16, 0xC3
        sts  TCCR2A, r16
        ldi  r16, 1
        sts  TCCR2B, r16
        ldi  r16, 200
        sts  TCNT2, r16
        ldi  r16, 1
        sts  TIMSK2, r16
        sei
        out  SPDR, r16
loop:   rjmp loop
)";

ChipOptions with_watch() {
    ChipOptions options;
    options.watch_hertz = 32'768;
    return options;
}

std::vector<std::uint8_t> saved(const Rig& rig) {
    std::vector<std::uint8_t> bytes;
    StateWriter writer(bytes);
    rig.chip.state(writer);
    return bytes;
}
void load(Rig& rig, std::span<const std::uint8_t> bytes) {
    StateReader reader(bytes);
    rig.chip.state(reader);
}

/// The least number of edges in the end.
void check_copies(const char* program, std::size_t edges) {
    RandomStream random(11, "avr state");
    Rig original(program, with_watch());
    original.volts[0] = 2.0;
    for (int i = 0; i < 12; ++i) {
        original.chip.run_until(original.chip.now() + static_cast<cosim::Time>(random.below(900'000'000)));
        const auto state = saved(original);
        Rig copy(program, with_watch());
        copy.volts[0] = 2.0;
        load(copy, state);
        CHECK(saved(copy) == state);
        Rig again(program, with_watch());
        again.volts[0] = 2.0;
        load(again, state);
        again.chip.set_skipping(false);
        copy.edges.clear();
        again.edges.clear();
        copy.chip.run_until(original.chip.now() + 2 * cosim::kMillisecond);
        again.chip.run_until(original.chip.now() + 2 * cosim::kMillisecond);
        const std::size_t before = original.edges.size(), sent = original.frames.size();
        original.chip.run_until(original.chip.now() + 2 * cosim::kMillisecond);
        REQUIRE(copy.edges.size() == original.edges.size() - before);
        for (std::size_t n = 0; n < copy.edges.size(); ++n) {
            REQUIRE(copy.edges[n].at == original.edges[before + n].at);
            REQUIRE(copy.edges[n].levels == original.edges[before + n].levels);
        }
        CHECK(copy.frames.size() == original.frames.size() - sent);
        CHECK(saved(copy) == saved(original));
        CHECK(saved(again) == saved(original));
    }
    CHECK(original.edges.size() > edges);
}

}  // namespace

TEST_CASE("a copy of a chip goes on as the original does") {
    check_copies(kProgram, 50);
}

TEST_CASE("a copy of a chip whose clock lines run goes on as the original does") {
    check_copies(kClocked, 10'000);
}

TEST_CASE("a damaged state is refused or harmless") {
    const char* const program = GENERATE(kProgram, kClocked);
    Rig rig(program, with_watch());
    rig.chip.run_until(3 * cosim::kMillisecond);
    const auto state = saved(rig);
    RandomStream random(12, "avr damage");
    int refused = 0;
    Rig victim(program, with_watch());
    for (int i = 0; i < 150; ++i) {
        auto bytes = state;
        if (i % 10 == 0)
            bytes.resize(random.below(bytes.size()));
        else
            bytes[random.below(2000)] ^= static_cast<std::uint8_t>(1u << random.below(8));
        try {
            load(victim, bytes);
        } catch (const StateError&) {
            ++refused;
        }
    }
    CHECK(refused > 10);
}
