// The board at its pins, by small programs.
#include "base/states/archive.h"
#include "tests/tam_board/rig.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace puckloop;
using namespace puckloop::tam;
using test::Rig;

namespace {

constexpr cosim::Time kMs = cosim::kMillisecond, kUs = cosim::kMicrosecond;

/// Writes two bytes to the LED driver again and again: `first` is the register number, `second` its value.
const std::string kTwoWire = R"(
start:  ldi r16, 72
        sts TWBR, r16
        rcall light
done:   rjmp done
send:   sts TWDR, r17
        ldi r16, 0x84
go:     sts TWCR, r16
wait:   lds r16, TWCR
        sbrs r16, 7
        rjmp wait
        ret
write:  ldi r16, 0xA4
        rcall go
        ldi r17, 0xC0
        rcall send
        mov r17, r18
        rcall send
        mov r17, r19
        rcall send
        ldi r16, 0x94
        sts TWCR, r16
stop:   lds r16, TWCR
        sbrc r16, 4
        rjmp stop
        ret
light:  ldi r18, 0x00
        ldi r19, 0x01
        rcall write
        ldi r18, 0x14
        ldi r19, 0x02
        rcall write
        ldi r18, 0x02
        ldi r19, 0x37
        rcall write
        ret
)";

}  // namespace

TEST_CASE("a write to the LED driver takes 28 clocks and the STOP at 100 kHz") {
    Rig rig;
    rig.board.load(test::assembled(kTwoWire));
    rig.board.run_until(5 * kMs);
    const auto lit = rig.of(kLed);
    REQUIRE(lit.size() == 1);
    CHECK(lit[0].value == 55.0 / 256.0);
    // Three writes; each has START, three bytes of nine clocks and STOP, and the program's instructions
    // between.
    const cosim::Time write = rig.phases[7].start - rig.phases[3].start;
    CHECK(rig.phases.size() == 12);
    CHECK(write > 290 * kUs);
    CHECK(write < 300 * kUs);
    for (const cosim::I2cPhase& phase : rig.phases)
        if (phase.kind != cosim::I2cPhaseKind::Stop) CHECK(phase.ack);
}

TEST_CASE("a light barrier is seen through the beam, the daylight and what interrupts it") {
    LightBarrier barrier({1.0, 50 * kUs});
    barrier.set_ambient(0.2);
    CHECK(barrier.volts(0) == Approx(0.2));
    barrier.set_duty(LightBarrier::kFirmwareDuty, 0);
    CHECK(barrier.volts(0) == Approx(0.2));
    CHECK(barrier.volts(50 * kUs) == Approx(0.2 + 1 - std::exp(-1.0)));
    CHECK(barrier.volts(kMs) == Approx(1.2));
    barrier.set_interrupted(1.0, kMs);
    CHECK(barrier.volts(2 * kMs) == Approx(0.2));
    barrier.set_interrupted(0.5, 2 * kMs);
    CHECK(barrier.volts(3 * kMs) == Approx(0.7));
    barrier.set_duty(1.0, 3 * kMs);
    CHECK(barrier.volts(4 * kMs) == Approx(0.2 + 0.5 * 256 / 55));
    barrier.set_ambient(3.3);
    CHECK(barrier.volts(4 * kMs) == 3.3);  // the supply
}

TEST_CASE("the booth goes dark for good one millisecond after the firmware asks for it") {
    Rig rig;
    rig.board.load(test::assembled(R"(
        sbi DDRC, 3
        sbi PORTC, 3
        sbi DDRB, 3
        sbi PORTB, 3
loop:   sbi PINC, 3
        rjmp loop
)"));
    rig.board.run_until(20 * kMs);
    const auto asked = rig.of(kPowerClear), power = rig.of(kPower), led = rig.of(kNetworkLed);
    REQUIRE(asked.size() == 2);
    REQUIRE(power.size() == 1);
    CHECK(power[0].at == asked[0].at + kMs);
    CHECK(power[0].value == 0.0);
    CHECK(led.back().at <= power[0].at);
    CHECK_FALSE(rig.board.powered());
    CHECK(rig.board.now() == 20 * kMs);
    // What it did does not depend on how it was run.
    Rig cut;
    cut.board.load(test::assembled("loop: rjmp loop\n"));
    Rig again;
    again.board.load(test::assembled(R"(
        sbi DDRC, 3
        sbi PORTC, 3
        sbi DDRB, 3
        sbi PORTB, 3
loop:   sbi PINC, 3
        rjmp loop
)"));
    for (cosim::Time now = 0; now < 20 * kMs; now += 77 * kUs)
        again.board.run_until(now);
    again.board.run_until(20 * kMs);
    CHECK(again.board.chip().cycle() == rig.board.chip().cycle());
    CHECK(again.changes.size() == rig.changes.size());
    again.board.set_signal(kNetworkSwitch, 0);
    again.board.reset_button();  // nothing happens any more
    again.board.run_until(30 * kMs);
    CHECK(again.board.chip().cycle() == rig.board.chip().cycle());
}

TEST_CASE("switches, battery and barriers are read at their pins") {
    Rig rig;
    rig.board.load(test::assembled(R"(
        result = 0x200
        ldi r16, 0x14
        out PORTB, r16
loop:   in r16, PINB
        andi r16, 0x14
        sts result, r16
        ldi r16, 0x41
        sts ADMUX, r16
        ldi r16, 0xC7
        sts ADCSRA, r16
wait:   lds r16, ADCSRA
        sbrc r16, 6
        rjmp wait
        lds r16, ADCL
        sts result + 1, r16
        lds r16, ADCH
        sts result + 2, r16
        rjmp loop
)"));
    const auto battery = [&] {
        return rig.board.chip().peek_data(0x201) | rig.board.chip().peek_data(0x202) << 8;
    };
    rig.board.run_until(10 * kMs);
    CHECK(rig.board.chip().peek_data(0x200) == 0x14);
    CHECK(battery() == 115);  // TAM fact sheet, section 4: 3.70 V
    rig.board.set_signal(kNetworkSwitch, 0);
    rig.board.set_signal(kBattery, 4.2);
    rig.board.run_until(20 * kMs);
    CHECK(rig.board.chip().peek_data(0x200) == 0x04);
    CHECK(battery() == 130);
    rig.board.set_signal(kNetworkSwitch, 1);
    rig.board.set_signal(kNetworkSwitch + 1, 0);
    rig.board.set_signal(kLed, 1.0);  // an output: ignored
    rig.board.run_until(30 * kMs);
    CHECK(rig.board.chip().peek_data(0x200) == 0x10);
    CHECK(rig.board.signal(kLed) == 0.0);
}

TEST_CASE("a board that loads another one's state goes on as that one does") {
    Rig one;
    one.board.load(test::assembled(kTwoWire));
    one.board.run_until(400 * kUs);
    std::vector<std::uint8_t> bytes;
    StateWriter writer(bytes);
    one.board.state(writer);
    Rig other;
    other.board.load(test::assembled(kTwoWire));
    StateReader reader(bytes);
    other.board.state(reader);
    one.changes.clear();
    one.board.run_until(5 * kMs);
    other.board.run_until(5 * kMs);
    REQUIRE(other.changes.size() == one.changes.size());
    for (std::size_t i = 0; i < one.changes.size(); ++i)
        CHECK(other.changes[i].at == one.changes[i].at);
    CHECK(other.board.chip().cycle() == one.board.chip().cycle());
    CHECK(other.board.signal(kLed) == 55.0 / 256.0);
}
