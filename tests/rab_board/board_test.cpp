// The board at its pins, driven as a chip would drive them. What needs firmware is in the acceptance tests.

#include "emu/rab_board/board.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

using namespace puckloop;
using dspic::PortLetter;

namespace {

struct Heard : rab::BoardListener {
    std::vector<std::pair<std::string, double>> signals;
    std::vector<cosim::I2cPhase> answers;
    std::vector<std::uint16_t> emitters;
    void signal_changed(rab::SignalId id, double value, cosim::Time) override {
        signals.emplace_back(rab::signals()[id].name, value);
    }
    void emitters_changed(std::uint16_t on, cosim::Time) override { emitters.push_back(on); }
    void uart_sent(int, const cosim::UartFrame&) override {}
    void i2c_answer(const cosim::I2cPhase& answer, cosim::Time) override { answers.push_back(answer); }
    void i2c_phase(int, const cosim::I2cPhase&) override {}
};

using Changes = std::vector<std::pair<std::string, double>>;

}  // namespace

TEST_CASE("a demodulator that sees carrier pulls its pin low, others stay high") {
    Heard heard;
    rab::Board board({}, heard);
    CHECK(board.levels(PortLetter::D, 0) == 0xFFF0);
    CHECK(board.set_signal(rab::kDemodulator, 1, 0) == PortLetter::D);
    CHECK(board.set_signal(rab::kDemodulator + 11, 1, 0) == PortLetter::D);
    CHECK(board.levels(PortLetter::D, 0) == 0x7FE0);
    CHECK_FALSE(board.set_signal(rab::kDemodulator, 1, 0).has_value());  // no edge
    CHECK(board.set_signal(rab::kDemodulator, 0, 0) == PortLetter::D);
    CHECK(board.levels(PortLetter::D, 0) == 0x7FF0);
    CHECK_FALSE(board.set_signal(rab::kEmitter, 1, 0).has_value());  // an output
    CHECK(heard.signals.empty());
}

TEST_CASE("peak detectors stand at AN20 to AN31, and their reset lines at twelve pins of three ports") {
    Heard heard;
    rab::BoardParameters parameters;
    parameters.adc_noise_counts = 0;
    rab::Board board(parameters, heard);
    for (int i = 0; i < rab::kSensorCount; ++i)
        board.set_signal(static_cast<rab::SignalId>(rab::kPeak + i), 100 + i, 0);
    for (int i = 0; i < rab::kSensorCount; ++i)
        CHECK(static_cast<int>(board.analog(20 + i, 0) * 4096) == 100 + i);
    CHECK(board.analog(5, 0) == 0.0);
    const std::pair<PortLetter, int> resets[] = {
        {PortLetter::F, 0},  {PortLetter::F, 1},  {PortLetter::G, 0},  {PortLetter::G, 1},
        {PortLetter::G, 12}, {PortLetter::G, 13}, {PortLetter::G, 14}, {PortLetter::G, 15},
        {PortLetter::A, 5},  {PortLetter::A, 4},  {PortLetter::A, 1},  {PortLetter::A, 0}};
    for (int i = 0; i < rab::kSensorCount; ++i) {
        const auto [port, bit] = resets[i];
        heard.signals.clear();
        const auto mask = static_cast<std::uint16_t>(1u << bit);
        board.driven(port, mask, mask, 0);
        board.driven(port, 0, mask, 0);
        const std::string name = "peak_reset" + std::to_string(i + 1);
        CHECK(heard.signals == Changes{{name, 1}, {name, 0}});
    }
}

TEST_CASE("no emitter is on without carrier, whatever gates and supply do") {
    Heard heard;
    rab::Board board({}, heard);
    board.driven(PortLetter::F, 0x1000, 0x1000, 0);
    board.driven(PortLetter::B, 0xFF39, 0xFF3D, 0);
    CHECK(board.emitters() == 0);
    CHECK(heard.signals.empty());
}

TEST_CASE("a byte shifted into the selected potentiometer becomes the emitters' power after it settled") {
    Heard heard;
    rab::Board board({}, heard);
    board.driven(PortLetter::B, 0x0004, 0x0004, 0);
    board.spi_exchange(1, 0x11, 8, 0);
    board.driven(PortLetter::B, 0x0000, 0x0004, 0);
    board.spi_exchange(2, 0x22, 8, 0);  // the other module is not wired
    board.spi_exchange(1, 0x64, 8, 0);
    board.driven(PortLetter::B, 0x0004, 0x0004, 0);
    board.settle(rab::kPotentiometerSettling - 1);
    CHECK(heard.signals.empty());
    board.settle(rab::kPotentiometerSettling);
    CHECK(heard.signals == Changes{{"power", 0x64}});
}

TEST_CASE("ADC noise comes from the board's own stream") {
    Heard heard;
    rab::BoardParameters parameters;
    parameters.adc_noise_counts = 3;
    rab::Board one(parameters, heard), again(parameters, heard);
    parameters.name = "other";
    rab::Board other(parameters, heard);
    for (rab::Board* board : {&one, &again, &other})
        board->set_signal(rab::kPeak, 2000, 0);
    int same = 0;
    for (int i = 0; i < 50; ++i) {
        const double value = one.analog(20, 0);
        CHECK(value == again.analog(20, 0));
        CHECK(value * 4096 == Approx(2000).margin(20));
        same += value == other.analog(20, 0) ? 1 : 0;
    }
    CHECK(same < 40);
}
