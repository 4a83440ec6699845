// Interrupts, sleep, pins, ADC, EEPROM, watchdog, SPI, two-wire interface, self-programming, fuses.

#include "tests/avr/rig.h"

#include <catch2/catch.hpp>

#include <memory>

using namespace puckloop;
using namespace puckloop::avr;
using test::Rig;
using Kind = cosim::I2cPhaseKind;

TEST_CASE("the instruction behind SEI comes before any interrupt, and one of the main program behind RETI") {
    Rig rig(R"(
        jmp start
        jmp int0            ; INT0
        .org 0x80
int0:   in  r20, PORTA      ; what the main program reached
        st  X+, r20
        reti
start:  ldi r26, 0
        ldi r27, 1
        ldi r16, 3          ; level-triggered by default; PD2 is low
        ldi r16, 1
        out EIMSK, r16
        nop
        sei
        sbi PORTA, 0
        sbi PORTA, 1
        sbi PORTA, 2
loop:   rjmp loop
)");
    rig.outside[3] = 0xFB;
    rig.chip.pins_changed(PortLetter::D);
    rig.run(120);
    CHECK(rig.ram(0x100) == 0x01);
    CHECK(rig.ram(0x101) == 0x03);
    CHECK(rig.ram(0x102) == 0x07);
}

TEST_CASE("edges, levels and pin changes interrupt, a flag waits for its mask and is cleared by a one") {
    Rig rig(R"(
        ldi r16, 0x02       ; INT0 falling
        sts EICRA, r16
        ldi r16, 0x40
        sts PCMSK1, r16
loop:   rjmp loop
)");
    rig.run(20);
    rig.set_pin({PortLetter::D, 2}, false);
    CHECK(rig.chip.peek("EIFR") == 1);
    rig.set_pin({PortLetter::D, 2}, true);
    CHECK(rig.chip.peek("EIFR") == 1);
    rig.set_pin({PortLetter::B, 5}, false);
    CHECK(rig.chip.peek("PCIFR") == 0);
    rig.set_pin({PortLetter::B, 6}, false);
    CHECK(rig.chip.peek("PCIFR") == 2);
}

TEST_CASE("PIN reads one clock late, writing it toggles PORT") {
    Rig rig(R"(
        ldi r16, 0xFF
        out DDRC, r16
        out PORTC, r16
        in  r17, PINC
        in  r18, PINC
        ldi r16, 0x0F
        out PINC, r16
        in  r19, PORTC
        sts 0x100, r17
        sts 0x101, r18
        sts 0x102, r19
loop:   rjmp loop
)");
    rig.outside[2] = 0;
    rig.run(50);
    CHECK(rig.ram(0x100) == 0x00);
    CHECK(rig.ram(0x101) == 0xFF);
    CHECK(rig.ram(0x102) == 0xF0);
}

TEST_CASE("sleep ends with an interrupt, four clocks later than an awake CPU's") {
    Rig rig(R"(
        jmp start
        .org 0x20           ; WDT
        sbi PORTA, 0
        reti
start:  sbi DDRA, 0
        sbi DDRA, 1
        ldi r16, 0x18
        ldi r17, 0x40       ; interrupt mode, 16 ms
        sts WDTCSR, r16
        sts WDTCSR, r17
        ldi r16, 1
        out SMCR, r16
        sei
        sleep
        sbi PORTA, 1
loop:   rjmp loop
)");
    rig.run(1000);
    CHECK(rig.chip.sleeping());
    rig.run(16 * 16000 + 1000);
    const auto woke = rig.changes({PortLetter::A, 0});
    REQUIRE(woke.size() == 1);
    CHECK_FALSE(rig.chip.sleeping());
    CHECK(rig.changes({PortLetter::A, 1}).size() == 1);
    CHECK(woke[0] >= 256000 + 8);
    CHECK(woke[0] <= 256000 + 40);
}

TEST_CASE("the watchdog resets, sets WDRF, and stays on until that is cleared") {
    Rig rig(R"(
        in  r16, MCUSR
        sts 0x100, r16
        lds r17, WDTCSR
        sts 0x101, r17
        sbrc r16, 3
        rjmp end
        ldi r16, 0x18
        ldi r17, 0x08       ; reset mode, 16 ms
        sts WDTCSR, r16
        sts WDTCSR, r17
end:    rjmp end
)");
    rig.run(17 * 16000);
    CHECK(rig.ram(0x100) == 0x09);  // WDRF beside PORF
    CHECK(rig.ram(0x101) == 0x08);
    const auto report = rig.chip.report();
    REQUIRE(report.resets.size() == 2);
    CHECK(report.resets[1].cause == ResetCause::Watchdog);
    CHECK(report.resets[1].cycle == Approx(256000).margin(20));
}

TEST_CASE("the first conversion takes 25 ADC clocks, the next ones 13") {
    Rig rig(R"(
        sbi DDRA, 7
        ldi r16, 0x41       ; AVCC, channel 1
        sts ADMUX, r16
        ldi r16, 0xC7       ; on, start, /128
        sts ADCSRA, r16
        sbi PINA, 7
first:  lds r17, ADCSRA
        sbrc r17, 6
        rjmp first
        sbi PINA, 7
        lds r20, ADCL
        lds r21, ADCH
        sts 0x100, r20
        sts 0x101, r21
        sts ADCSRA, r16
        sbi PINA, 7
second: lds r17, ADCSRA
        sbrc r17, 6
        rjmp second
        sbi PINA, 7
loop:   rjmp loop
)");
    rig.volts[1] = 1.25;
    rig.run(10000);
    const auto edges = rig.changes({PortLetter::A, 7});
    REQUIRE(edges.size() == 4);
    CHECK(edges[1] - edges[0] >= 25 * 128 - 3);
    CHECK(edges[1] - edges[0] <= 26 * 128 + 8);
    CHECK(edges[3] - edges[2] >= 13 * 128 - 3);
    CHECK(edges[3] - edges[2] <= 14 * 128 + 8);
    CHECK((rig.ram(0x100) | rig.ram(0x101) << 8) == 256);
}

TEST_CASE("the EEPROM programs behind its timed sequence only, in 3.4 ms, and is read back") {
    Rig rig(R"(
        ldi r16, 0x23
        out EEARL, r16
        ldi r17, 0x5A
        out EEDR, r17
        sbi EECR, 1         ; not armed: nothing
        sbi EECR, 2
        sbi EECR, 1
        sbi PORTA, 0
        sbi DDRA, 0
wait:   sbic EECR, 1
        rjmp wait
        cbi PORTA, 0
        ldi r17, 0
        out EEDR, r17
        sbi EECR, 0
        in  r18, EEDR
        sts 0x100, r18
loop:   rjmp loop
)");
    rig.run(100000);
    CHECK(rig.chip.eeprom()[0x23] == 0x5A);
    CHECK(rig.ram(0x100) == 0x5A);
    const auto edges = rig.changes({PortLetter::A, 0});
    REQUIRE(edges.size() == 2);
    CHECK(edges[1] - edges[0] == Approx(3.4e-3 * 16e6).margin(20));
}

TEST_CASE("the SPI master exchanges a byte in eight of its clocks, SPIF clears by reading") {
    Rig rig(R"(
        ldi r16, 0x51       ; on, master, /16
        out SPCR, r16
        ldi r16, 0x3C
        out SPDR, r16
wait:   in  r17, SPSR
        sbrs r17, 7
        rjmp wait
        in  r18, SPDR
        in  r19, SPSR
        sts 0x100, r18
        sts 0x101, r19
loop:   rjmp loop
)");
    rig.run(400);
    REQUIRE(rig.exchanges.size() == 1);
    CHECK(rig.exchanges[0].first == 0x3C);
    CHECK(rig.exchanges[0].second == Approx(3 + 8 * 16).margin(2));
    CHECK(rig.ram(0x100) == 0xC3);
    CHECK(rig.ram(0x101) == 0);
}

TEST_CASE("the two-wire master: START, address, data, STOP with the data sheet's status codes and times") {
    Rig rig(R"(
        ldi r26, 0
        ldi r27, 1
        ldi r16, 72         ; 100 kHz
        sts TWBR, r16
        ldi r16, 0xA4
        rcall go            ; START
        ldi r17, 0xC0
        sts TWDR, r17
        ldi r16, 0x84
        rcall go            ; address
        ldi r17, 0x17
        sts TWDR, r17
        rcall go            ; data
        ldi r16, 0x94
        sts TWCR, r16       ; STOP
stop:   lds r17, TWCR
        sbrc r17, 4
        rjmp stop
        lds r17, TWSR
        st  X+, r17
loop:   rjmp loop
go:     sts TWCR, r16
wait:   lds r17, TWCR
        sbrs r17, 7
        rjmp wait
        lds r17, TWSR
        st  X+, r17
        ret
)");
    const cosim::Time limit = 2 * cosim::kMillisecond;
    std::size_t answered = 0;
    while (rig.chip.now() < limit) {
        rig.chip.run_until(rig.chip.now() + 10 * cosim::kMicrosecond);
        if (rig.phases.size() == answered) continue;
        const cosim::I2cPhase phase = rig.phases[answered++];
        if (phase.kind == Kind::Stop) continue;
        rig.chip.run_until(phase.start + 9 * phase.clock_period);
        cosim::I2cPhase answer = phase;
        answer.kind = Kind::Acknowledge;
        answer.ack = phase.kind == Kind::Start;  // the address is acknowledged, the data byte not
        rig.chip.twi_answer(answer);
    }
    REQUIRE(rig.phases.size() == 3);
    CHECK(rig.phases[0].kind == Kind::Start);
    CHECK(rig.phases[0].byte == 0xC0);
    CHECK(rig.phases[0].clock_period == 10 * cosim::kMicrosecond);
    CHECK(rig.phases[1].kind == Kind::Write);
    CHECK(rig.phases[1].byte == 0x17);
    CHECK(rig.phases[2].kind == Kind::Stop);
    CHECK(rig.ram(0x100) == 0x08);
    CHECK(rig.ram(0x101) == 0x18);
    CHECK(rig.ram(0x102) == 0x30);
    CHECK(rig.ram(0x103) == 0xF8);
}

// Data sheet 8272, 21.9: TWWC is cleared by writing TWDR while TWINT is high, and by nothing else; TWSR holds
// a status while TWINT is set, at all other times 0xF8; TWDR always contains the last byte on the bus.
TEST_CASE("TWWC, TWSR without TWINT and TWDR after a lost arbitration") {
    Rig rig(R"(
        ldi r16, 72         ; 100 kHz
        sts TWBR, r16
        ldi r16, 0xA4
        sts TWCR, r16       ; START
        rcall wait
        ldi r17, 0xC1
        sts TWDR, r17
        ldi r16, 0x84
        sts TWCR, r16       ; address
        ldi r17, 0x55
        sts TWDR, r17       ; too early
        lds r17, TWSR
        sts 0x0100, r17     ; while TWINT is low
        rcall wait
        lds r17, TWCR
        sts 0x0101, r17
        lds r17, TWDR
        sts 0x0102, r17
        lds r17, TWSR
        sts 0x0103, r17
        sts TWCR, r16       ; let the bus go
        lds r17, TWCR
        sts 0x0104, r17
        lds r17, TWSR
        sts 0x0105, r17
loop:   rjmp loop
wait:   lds r17, TWCR
        sbrs r17, 7
        rjmp wait
        ret
)");
    while (rig.phases.empty())
        rig.chip.run_until(rig.chip.now() + cosim::kMicrosecond);
    cosim::I2cPhase answer = rig.phases[0];
    CHECK(answer.byte == 0xC1);
    const cosim::Time begun = answer.start;
    answer.kind = Kind::BusLost;
    answer.byte = 0x9A;
    rig.chip.run_until(begun + 2 * answer.clock_period);
    rig.chip.twi_answer(answer);
    rig.chip.run_until(begun + 8 * answer.clock_period);
    CHECK(rig.ram(0x103) == 0);  // the status comes with the ninth clock
    rig.chip.run_until(begun + 11 * answer.clock_period);
    CHECK(rig.ram(0x100) == 0xF8);
    CHECK((rig.ram(0x101) & 0x88) == 0x88);
    CHECK(rig.ram(0x102) == 0x9A);
    CHECK(rig.ram(0x103) == 0x38);
    CHECK((rig.ram(0x104) & 0x88) == 0x08);
    CHECK(rig.ram(0x105) == 0xF8);
}

namespace {

/// A phase of a bus master at 100 kHz begins now.
void begin_two_wire_phase(Rig& rig, Kind kind, std::uint8_t byte) {
    cosim::I2cPhase phase;
    phase.kind = kind;
    phase.byte = byte;
    phase.start = rig.chip.now();
    phase.clock_period = 10 * cosim::kMicrosecond;
    rig.chip.twi_slave_phase(phase);
}

}  // namespace

TEST_CASE("the two-wire slave acknowledges its address and stretches SCL until TWINT is cleared") {
    Rig rig(R"(
        ldi r26, 0
        ldi r27, 1
        ldi r16, 0x42       ; address 0x21
        sts TWAR, r16
        ldi r16, 0xC4
        sts TWCR, r16
wait:   lds r17, TWCR
        sbrs r17, 7
        rjmp wait
        lds r17, TWSR
        st  X+, r17
        lds r17, TWDR
        st  X+, r17
        ldi r18, 200
slow:   dec r18
        brne slow
        sts TWCR, r16
        rjmp wait
)");
    rig.run(100);
    const auto phase = [&](Kind kind, std::uint8_t byte) {
        const std::size_t before = rig.answers.size();
        begin_two_wire_phase(rig, kind, byte);
        for (int i = 0; i < 1000 && kind != Kind::Stop && rig.answers.size() == before; ++i)
            rig.chip.run_until(rig.chip.now() + cosim::kMicrosecond);
        rig.chip.run_until(rig.chip.now() + 10 * cosim::kMicrosecond);
    };
    phase(Kind::Start, 0x44);  // another address
    // A START within its byte would be a bus error.
    rig.chip.run_until(rig.chip.now() + 90 * cosim::kMicrosecond);
    phase(Kind::Start, 0x42);
    phase(Kind::Write, 0x99);
    phase(Kind::Stop, 0);
    rig.chip.run_until(rig.chip.now() + cosim::kMillisecond);
    REQUIRE(rig.answers.size() == 3);
    CHECK(rig.answers[0].ack == 0);
    CHECK(rig.answers[1].ack == 1);
    CHECK(rig.answers[2].ack == 1);
    CHECK(rig.answers[2].stretch > 20 * cosim::kMicrosecond);
    CHECK(rig.ram(0x100) == 0x60);
    CHECK(rig.ram(0x102) == 0x80);
    CHECK(rig.ram(0x103) == 0x99);
    CHECK(rig.ram(0x104) == 0xA0);
}

TEST_CASE("TWSTO of a slave: it is not addressed any more, no STOP is made, the bit clears itself") {
    Rig rig(R"(
        ldi r26, 0
        ldi r27, 1
        ldi r16, 0x42
        sts TWAR, r16
        ldi r16, 0xC4
        sts TWCR, r16
wait:   lds r17, TWCR
        sbrs r17, 7
        rjmp wait
        lds r17, TWSR
        st  X+, r17
        ldi r16, 0xC4
        cpi r17, 0x80
        brne go
        ldi r16, 0xD4       ; TWSTO with the first byte
go:     sts TWCR, r16
        rjmp wait
)");
    rig.run(100);
    const auto phase = [&](Kind kind, std::uint8_t byte) {
        begin_two_wire_phase(rig, kind, byte);
        rig.chip.run_until(rig.chip.now() + 100 * cosim::kMicrosecond);
    };
    phase(Kind::Start, 0x42);
    phase(Kind::Write, 0x55);
    phase(Kind::Write, 0x03);
    phase(Kind::Stop, 0);
    REQUIRE(rig.answers.size() == 3);
    CHECK(rig.answers[1].ack == 1);
    CHECK(rig.answers[2].ack == 0);
    CHECK(rig.ram(0x100) == 0x60);
    CHECK(rig.ram(0x101) == 0x80);
    CHECK(rig.ram(0x102) == 0x00);  // neither 0x80 nor 0xA0
    CHECK((rig.chip.peek("TWCR") & 0x10) == 0);
    phase(Kind::Start, 0x42);  // it takes part again
    REQUIRE(rig.answers.size() == 4);
    CHECK(rig.answers[3].ack == 1);
}

TEST_CASE("the boot section writes a page, and reads fuses and signature") {
    ChipOptions options;
    options.fuses = {0xFF, 0xDE, 0xFD, 0xEF};
    Rig rig(R"(
        .org 0x1FC00        ; BOOTRST, 512 words
        ldi r30, 0x00
        ldi r31, 0x02       ; page at 0x200
        ldi r16, 0x11
        mov r0, r16
        ldi r16, 0x22
        mov r1, r16
        ldi r16, 0x01
        out SPMCSR, r16
        spm                 ; a word into the buffer
        ldi r16, 0x03
        out SPMCSR, r16
        spm                 ; erase
busy:   in  r17, SPMCSR
        sbrc r17, 0
        rjmp busy
        ldi r16, 0x05
        out SPMCSR, r16
        spm                 ; write
more:   in  r17, SPMCSR
        sbrc r17, 0
        rjmp more
        lpm r20, Z          ; the section is busy until it is enabled again
        ldi r16, 0x11
        out SPMCSR, r16
        spm
        lpm r21, Z+
        lpm r22, Z
        ldi r30, 3
        ldi r31, 0
        ldi r16, 0x09
        out SPMCSR, r16
        lpm r23, Z          ; high fuse
        ldi r30, 2
        ldi r16, 0x21
        out SPMCSR, r16
        lpm r24, Z          ; signature
        sts 0x100, r20
        sts 0x101, r21
        sts 0x102, r22
        sts 0x103, r23
        sts 0x104, r24
loop:   rjmp loop
)",
            options);
    rig.run(200000);
    CHECK(rig.ram(0x100) == 0xFF);
    CHECK(rig.ram(0x101) == 0x11);
    CHECK(rig.ram(0x102) == 0x22);
    CHECK(rig.ram(0x103) == 0xDE);
    CHECK(rig.ram(0x104) == 0x97);
}

TEST_CASE("CLKPR changes the clock behind its timed sequence") {
    Rig rig(R"(
        ldi r16, 0x80
        ldi r17, 3
        sts CLKPR, r16
        sts CLKPR, r17
loop:   rjmp loop
)");
    rig.chip.run_until(cosim::kMillisecond);
    CHECK(rig.chip.cycle() == Approx(2000).margin(10));
}

TEST_CASE("an address without a register is reported once") {
    Rig rig("        lds r0, 0x2C\n        lds r0, 0x2C\n        sts 0xD0, r0\nloop:   rjmp loop\n");
    rig.run(20);
    const auto touches = rig.chip.report().unmodelled;
    REQUIRE(touches.size() == 2);
    CHECK(touches[0].address == 0x2C);
    CHECK(touches[1].write);
    CHECK(touches[1].pc == 8);
}

TEST_CASE("differential channels of the ADC give two's complement, with gain") {
    const auto convert = [](int mux, double plus, double minus, int positive, int negative) {
        Rig rig("ldi r16, " + std::to_string(0x40 | mux) + R"(
        sts ADMUX, r16
        ldi r16, 0xC7
        sts ADCSRA, r16
busy:   lds r17, ADCSRA
        sbrc r17, 6
        rjmp busy
        lds r20, ADCL
        lds r21, ADCH
        sts 0x100, r20
        sts 0x101, r21
end:    rjmp end
)");
        rig.volts[static_cast<std::size_t>(positive)] = plus;
        rig.volts[static_cast<std::size_t>(negative)] = minus;
        rig.run(6000);
        const int code = rig.ram(0x100) | rig.ram(0x101) << 8;
        return code >= 512 ? code - 1024 : code;
    };
    CHECK(convert(0x10, 3.0, 2.0, 0, 1) == 102);   // ADC0 - ADC1: 1 V of 5 V, 512 steps
    CHECK(convert(0x10, 2.0, 3.0, 0, 1) == -103);  // rounded down
    CHECK(convert(0x1D, 4.0, 1.5, 5, 2) == 256);   // ADC5 - ADC2
    CHECK(convert(0x09, 2.05, 2.0, 1, 0) == 51);   // (ADC1 - ADC0) x 10
    CHECK(convert(0x0F, 2.001, 2.0, 3, 2) == 20);  // (ADC3 - ADC2) x 200
    CHECK(convert(0x0F, 3.0, 2.0, 3, 2) == 511);   // clipped
    CHECK(convert(0x0B, 0.0, 1.0, 1, 0) == -512);
}

TEST_CASE("boot lock bits keep a section from being read by the other, and from being written") {
    // The boot section reads the application and erases a page of it; the application reads the boot section.
    const std::string source = R"(
        .org 0
        ldi r31, 0xFC
        ldi r30, 0
        ldi r16, 1
        out RAMPZ, r16
        elpm r20, Z         ; of the boot section
        sts 0x101, r20
end:    rjmp end
        .org 0x200
        .word 0x1234
        .org 0x1FC00
        ldi r31, 2
        ldi r30, 0
        lpm r20, Z          ; of the application
        sts 0x100, r20
        ldi r16, 3
        out SPMCSR, r16
        spm
busy:   in r17, SPMCSR
        sbrc r17, 0
        rjmp busy
        ldi r16, 0x11
        out SPMCSR, r16
        spm
        lpm r20, Z
        sts 0x102, r20
        ldi r31, 0
        ldi r30, 0
        jmp 0
)";
    const auto run = [&](std::uint8_t lock) {
        auto rig = std::make_unique<Rig>(source, ChipOptions{.fuses = {0xFF, 0xDE, 0xFD, lock}});
        rig->run(200'000);
        return rig;
    };
    const auto open = run(0xFF);
    CHECK(open->ram(0x100) == 0x34);
    CHECK(open->ram(0x101) == 0xF2);
    CHECK(open->ram(0x102) == 0xFF);
    const auto closed = run(0xC3);  // both sections in mode 3
    CHECK(closed->ram(0x100) == 0xFF);
    CHECK(closed->ram(0x101) == 0xFF);
    const auto readable = run(0xFB);  // BLB01 alone: the application may not be written
    CHECK(readable->ram(0x100) == 0x34);
    CHECK(readable->ram(0x102) == 0x34);
}

TEST_CASE("a program that hangs, starts over or sleeps for good is reported") {
    const auto warning = [](const Rig& rig) {
        const ChipReport report = rig.chip.report();
        return report.warnings.empty() ? std::string() : report.warnings.front().text;
    };
    Rig twi(R"(
        ldi r16, 0x04
        sts TWCR, r16       ; enabled, nothing begun
wait:   lds r17, TWCR
        sbrs r17, 7
        rjmp wait
)");
    twi.chip.run_until(400 * cosim::kMillisecond);
    CHECK_FALSE(twi.chip.hang());
    twi.chip.run_until(cosim::kSecond);
    REQUIRE(twi.chip.hang());
    CHECK(*twi.chip.hang() == "has run 1.0 s in the loop 0x0006..0x000c reading TWCR, but the two-wire "
                              "interface has nothing to do");
    Rig ram("wait: lds r16, 0x200\n tst r16\n breq wait\n");
    ram.chip.run_until(cosim::kSecond);
    REQUIRE(ram.chip.hang());
    CHECK(ram.chip.hang()->find("with interrupts off") != std::string::npos);
    Rig listens("sei\nldi r16, 0x10\n sts UCSR0B, r16\nwait: lds r16, UCSR0A\n sbrs r16, 7\n rjmp wait\n");
    listens.chip.run_until(cosim::kSecond);
    CHECK_FALSE(listens.chip.hang());  // a character may come
    Rig ended("cli\nend: rjmp end\n");
    ended.chip.run_until(cosim::kSecond);
    CHECK_FALSE(ended.chip.hang());

    Rig again(R"(
        jmp start
        .org 0x48           ; TIMER0_OVF, without a routine
        jmp 0
        .org 0x100
start:  ldi r16, 1
        sts TIMSK0, r16
        out TCCR0B, r16
        sei
wait:   rjmp wait
)");
    again.run(2000);
    CHECK(warning(again) ==
          "the program starts over at 0 without a reset; the last interrupt was TIMER0_OVF");
    Rig asleep("ldi r16, 5\n out SMCR, r16\n cli\n sleep\n nop\n");
    asleep.run(2000);
    CHECK(warning(asleep) == "sleeps with interrupts off: only a reset ends it");
}

TEST_CASE("each sleep mode wakes by its own sources, after its own start-up time, with its own clocks") {
    // Timer 0 overflows every 2048 clocks; INT0 is a level. 0x100 counts overflows, 0x102 is 1 once awake by
    // INT0.
    const auto sleeper = [](int mode, int fuse) {
        return std::make_unique<Rig>(
            R"(
        jmp start
        .org 0x04
        jmp int0
        .org 0x48
        lds r20, 0x100
        inc r20
        sts 0x100, r20
        reti
int0:   ldi r16, 0
        out EIMSK, r16
        ldi r16, 1
        sts 0x102, r16
        sbi PINB, 0
        reti
start:  sbi DDRB, 0
        ldi r16, 2
        out TCCR0B, r16
        ldi r16, 1
        sts TIMSK0, r16
        out EIMSK, r16
        ldi r16, )" +
                std::to_string(mode << 1 | 1) + R"(
        out SMCR, r16
        sei
loop:   sleep
        in r21, TCNT0
        sts 0x103, r21
        rjmp loop
)",
            ChipOptions{.fuses = {static_cast<std::uint8_t>(fuse), 0x99, 0xFD, 0xFF}});
    };
    struct Case {
        int mode, fuse;
        bool timer;
        Cycle start_up;
    };
    for (const Case& c : {Case{0, 0xFF, true, 0},
                          {1, 0xFF, false, 0},
                          {2, 0xFF, false, 16'384},
                          {2, 0xC2, false, 6},
                          {2, 0xCE, false, 258},
                          {3, 0xFF, false, 16'384},
                          {6, 0xFF, false, 6},
                          {7, 0xFF, false, 6}}) {
        INFO("mode " << c.mode << ", low fuse " << c.fuse);
        const auto rig = sleeper(c.mode, c.fuse);
        rig->run(100'000);
        const int overflows = rig->ram(0x100);
        CHECK((overflows > 40) == c.timer);
        CHECK((overflows < 2) == !c.timer);
        REQUIRE(rig->ram(0x102) == 0);
        rig->set_pin({PortLetter::D, 2}, false);
        rig->run(100'000 + c.start_up - 1);
        CHECK(rig->ram(0x102) == 0);
        rig->run(100'000 + c.start_up + 40);
        CHECK(rig->ram(0x102) == 1);
        // Awake in power-down, the timer has stood still.
        if (!c.timer) CHECK(rig->ram(0x103) < 20);
    }
}

TEST_CASE(
    "a model is behind every register of the data sheet's summary, and reserved addresses are reported") {
    Rig rig("end: rjmp end\n");
    rig.run(10);
    std::array<bool, 0x100> known{};
    for (const RegisterInfo& info : atmega1284p().registers) {
        known[info.address] = true;
        rig.chip.inside().core.read_data(info.address);
        const std::size_t before = rig.chip.report().unmodelled.size();
        INFO(info.name);
        CHECK(before == 0);
    }
    std::size_t reserved = 0;
    for (std::uint16_t address = 0x20; address < 0x100; ++address)
        if (!known[address]) {
            ++reserved;
            rig.chip.inside().core.read_data(address);
        }
    CHECK(rig.chip.report().unmodelled.size() == reserved);
}

TEST_CASE("what no model is behind is reported by name, once") {
    Rig rig(R"(
        ldi r16, 0x86
        sts UCSR0C, r16     ; a reserved mode
        sts UCSR0C, r16
        sts OSCCAL, r16
        out OCDR, r16
        sts 0x67, r16       ; no register
end:    rjmp end
)");
    rig.run(100);
    const ChipReport report = rig.chip.report();
    REQUIRE(report.unmodelled.size() == 4);
    CHECK(report.unmodelled[0].name == "UCSR0C.UMSEL0");
    CHECK(report.unmodelled[0].write);
    CHECK(report.unmodelled[1].name == "OSCCAL");
    CHECK(report.unmodelled[2].name == "OCDR");
    CHECK(report.unmodelled[3].name.empty());
    CHECK(report.unmodelled[3].address == 0x67);
}
