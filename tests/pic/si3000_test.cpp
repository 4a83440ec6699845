// The codec of the e-puck behind the DCI: commands in secondary frames, clocks, gains, and what drives the
// speaker.

#include "emu/pic/si3000.h"

#include "emu/dspic/chip/chip.h"
#include "emu/pic/board.h"
#include "tests/kit/node_under_test.h"
#include "tests/kit/sound_player.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <random>
#include <string>
#include <vector>

using namespace puckloop;
using pic::Si3000;

namespace {

constexpr std::uint32_t kBit = 8;  // cycles

/// A master that sends frames of `bits` bit clocks.
struct Master {
    Si3000 codec;
    dspic::Cycle now = 1000;
    unsigned bits = 128;
    double line_in = 0.0;

    std::uint16_t send(std::uint16_t value) {
        now += dspic::Cycle{bits} * kBit;
        return codec.exchange(
            {.slot = 0, .bits = 16, .driven = true, .value = value, .frame = now, .bit_cycles = kBit},
            line_in);
    }
    std::uint16_t command(std::uint16_t word) {
        send(0x7FFF);
        return send(word);
    }
    /// As the e-puck's library: 256 bit clocks a sample, speaker on, 0 dB.
    void set_up() {
        codec.set_released(true);
        for (const int word : {0x0300, 0x0413, 0x0118, 0x0200, 0x0602, 0x075F})
            command(static_cast<std::uint16_t>(word));
        bits = 256;
        send(0);
        send(0);
    }
};

}  // namespace

TEST_CASE("registers are written and read in secondary frames only, and fall back at reset", "[codec]") {
    Master m;
    m.command(0x0413);
    CHECK(m.codec.reg(4) == 0);  // held in reset
    m.codec.set_released(true);
    CHECK(m.codec.reg(7) == 0x5C);
    std::mt19937 random(1);
    for (const int number : {2, 3, 4, 5, 6, 7, 9}) {
        const auto value = static_cast<std::uint8_t>(random());
        const auto address = static_cast<std::uint16_t>(number << 8);
        m.command(static_cast<std::uint16_t>(address | value));
        CHECK(m.codec.reg(number) == value);
        CHECK(m.command(static_cast<std::uint16_t>(0x2000 | address)) == value);
        CHECK(m.codec.reg(number) == value);
    }
    m.send(0x0455);  // a sample, whatever it looks like: bit 0 asks for a command
    m.send(0x0766);
    CHECK(m.codec.reg(7) == 0x66);
    m.send(0x0754);  // not asked for
    m.send(0x0754);
    CHECK(m.codec.reg(7) == 0x66);
    m.command(0x0855);  // the status cannot be written
    CHECK(m.codec.reg(8) == 0);
    m.command(0x0180);  // soft reset
    CHECK(m.codec.reg(7) == 0x5C);
    m.command(0x0766);
    m.codec.set_released(false);
    m.codec.set_released(true);
    CHECK(m.codec.reg(7) == 0x5C);
}

TEST_CASE("samples drive the speaker by gain, attenuation and mutes", "[codec]") {
    Master m;
    m.set_up();
    CHECK(m.codec.sounding());
    std::mt19937 random(2);
    for (int i = 0; i < 50; ++i) {
        const auto sample = static_cast<std::int16_t>(random() & 0xFFFE);
        m.send(static_cast<std::uint16_t>(sample));
        CHECK(m.codec.speaker() == Approx(sample / 32768.0).margin(1e-12));
    }
    const auto heard = [&](std::uint16_t command) {
        m.bits = 128;
        m.command(command);
        m.send(0x2000);
        m.bits = 256;
        m.send(0x2000);
        m.send(0x2000);
        return m.codec.speaker();
    };
    CHECK(heard(0x075F) == Approx(0.25));
    CHECK(heard(0x075B) == Approx(0.25 * std::pow(10.0, -1.5 / 20)));
    CHECK(heard(0x0703) == Approx(0.25 * std::pow(10.0, -34.5 / 20)));
    CHECK(heard(0x077F) == Approx(0.25 * std::pow(10.0, 12.0 / 20)).epsilon(0.01));
    CHECK(heard(0x075D) == Approx(0.125));  // one side muted
    CHECK(heard(0x075C) == 0.0);
    CHECK(heard(0x075F) == Approx(0.25));
    CHECK(heard(0x0902) == Approx(0.25 * std::pow(10.0, -12.0 / 20)));
    CHECK(heard(0x0900) == Approx(0.25));
    CHECK(heard(0x0108) == 0.0);  // speaker driver off
    CHECK(heard(0x0118) == Approx(0.25));
    CHECK(heard(0x0119) == 0.0);  // chip off
}

TEST_CASE("nothing is converted where the PLL does not make the rate of the frame syncs", "[codec]") {
    Master m;
    m.set_up();
    m.bits = 128;
    m.send(0x4000);
    m.send(0x4000);
    CHECK(m.codec.speaker() == 0.0);
    m.command(0x0427);  // 40: twice the rate
    m.send(0x4000);
    m.send(0x4000);
    CHECK(m.codec.speaker() == Approx(0.5));
    m.command(0x0208);  // and half of it with PL
    m.bits = 256;
    m.send(0x4000);
    m.send(0x4000);
    CHECK(m.codec.speaker() == Approx(0.5));
    m.codec.set_released(false);
    CHECK(m.codec.speaker() == 0.0);
    CHECK(m.send(0x4000) == 0);
}

TEST_CASE("the line input comes in by its gains, and clips", "[codec]") {
    Master m;
    m.set_up();
    m.line_in = 0.1;
    const auto in = [&](std::uint16_t command) {
        m.bits = 128;
        m.command(command);
        m.send(0);
        m.bits = 256;
        m.send(0);
        return static_cast<std::int16_t>(m.send(0)) / 32768.0;
    };
    CHECK(in(0x065E) == Approx(0.1).margin(1e-4));
    CHECK(in(0x0652) == Approx(0.1 * std::pow(10.0, -4.5 / 20)).margin(1e-4));
    CHECK(in(0x065E) == Approx(0.1).margin(1e-4));
    CHECK(in(0x0540) == Approx(0.1 * std::pow(10.0, 10.0 / 20)).margin(1e-4));
    CHECK(in(0x0580) == Approx(1.0).margin(1e-4));
    CHECK(in(0x05A0) == 0.0);  // muted
}

namespace {

struct Ears : pic::BoardListener {
    void signal_changed(pic::SignalId id, double value, dspic::Cycle now) override {
        if (id == pic::kSpeaker) changes.push_back({value, now});
    }
    void uart_sent(int, const cosim::UartFrame&) override {}
    void i2c_phase(int, const cosim::I2cPhase&) override {}
    void sound_sample(double value, dspic::Cycle now) override { samples.push_back({value, now}); }
    struct Heard {
        double value;
        dspic::Cycle now;
    };
    std::vector<Heard> changes, samples;
};

}  // namespace

TEST_CASE("an own program sets the codec up and plays from its interrupt, sample by sample", "[codec]") {
    std::mt19937 random(Catch::rngSeed());
    const unsigned step = 2 * static_cast<unsigned>(random() % 5000u) + 301;
    CAPTURE(step);
    // Two more for each sample, times the step; RF0 falls after 1500 of them.
    const std::string source = tests::sound_player(
        "        inc2 w5, w5\n        mov #" + std::to_string(step) +
            ", w4\n        mul.uu w5, w4, w2\n        bclr w2, #0\n        mov w2, w3\n",
        "", "        mov #3000, w4\n        cp w5, w4\n        bra ltu, sleep\n        bclr LATF, #0\n");
    const image::Image program = tests::assembled(dspic::dspic30f6014a(), source);
    Ears ears;
    pic::BoardParameters parameters;
    pic::Board board(parameters, ears);
    dspic::Chip chip(dspic::dspic30f6014a(), board);
    chip.load(program);
    chip.power_on();
    chip.run_until(cosim::from_seconds(0.25));
    REQUIRE(ears.samples.size() > 1400);
    CHECK_FALSE(board.codec().released());
    CHECK(ears.changes.back().value == 0.0);
    // What the interrupt wrote two words ago, every 2048 cycles: 7200 Hz.
    std::size_t first = 0;
    while (ears.samples[first].value == 0.0)
        ++first;
    for (std::size_t i = 0; i < 1400; ++i) {
        const unsigned count = 2 * static_cast<unsigned>(i + 1);
        const auto wanted = static_cast<std::int16_t>((count * step) & 0xFFFEu);
        CHECK(ears.samples[first + i].value == Approx(wanted / 32768.0).margin(1e-12));
        CHECK(ears.samples[first + i].now - ears.samples[first].now == i * 2048);
    }
}

TEST_CASE("a sound at a microphone is the wave between its samples", "[sound]") {
    Ears ears;
    pic::BoardParameters parameters;
    parameters.adc_noise_counts = 0;
    pic::Board board(parameters, ears);
    const auto counts = [&](dspic::Cycle now) { return board.analog(3, now) * 4096.0 - 0.25; };
    CHECK(counts(10) == Approx(2048));
    board.set_signal(pic::kSound + 1, 100.0, 1000);
    CHECK(counts(1000) == Approx(2048));
    const double period = 62.5e-6 * 14'745'600;
    CHECK(counts(1000 + static_cast<dspic::Cycle>(period / 2)) == Approx(2098).margin(1));
    CHECK(counts(1000 + static_cast<dspic::Cycle>(period) + 1) == Approx(2148));
    CHECK(counts(100000) == Approx(2148));
    board.set_signal(pic::kSound + 1, -50.0, 200000);
    CHECK(counts(200000) == Approx(2148));
    CHECK(counts(201000) == Approx(1998));
    CHECK(board.analog(2, 201000) * 4096.0 == Approx(2048.25));
}
