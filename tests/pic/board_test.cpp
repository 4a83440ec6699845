#include "emu/pic/board.h"

#include "emu/pic/pin_table.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <set>
#include <vector>

using namespace puckloop;
using dspic::PortLetter;

namespace {

struct Heard : pic::BoardListener {
    struct Change {
        pic::SignalId id;
        double value;
        dspic::Cycle now;
        friend bool operator==(const Change&, const Change&) = default;
    };
    void signal_changed(pic::SignalId id, double value, dspic::Cycle now) override {
        changes.push_back({id, value, now});
    }
    void uart_sent(int, const cosim::UartFrame&) override {}
    void i2c_phase(int, const cosim::I2cPhase&) override {}
    std::vector<Change> changes;
};

pic::BoardParameters quiet() {
    pic::BoardParameters parameters;
    parameters.adc_noise_counts = 0;
    return parameters;
}

int counts(pic::Board& board, int channel, dspic::Cycle now) {
    return static_cast<int>(std::floor(board.analog(channel, now) * 4096));
}

constexpr std::uint16_t bit(int n) {
    return static_cast<std::uint16_t>(1u << n);
}

}  // namespace

TEST_CASE("no pin stands twice in the pin table, and every signal it names has the right direction") {
    std::set<std::pair<PortLetter, int>> seen;
    for (const pic::PinUse& pin : pic::wiring::kPins) {
        CHECK(seen.insert({pin.port, pin.bit}).second);
        CHECK(pin.bit < 16);
        const bool output = pin.role == pic::Role::Output || pin.role == pic::Role::Coil;
        const bool input = pin.role == pic::Role::Input || pin.role == pic::Role::InputLow;
        if (output) CHECK(pic::signals()[pin.signal].direction == cosim::SignalDirection::Output);
        if (input) CHECK(pic::signals()[pin.signal].direction == cosim::SignalDirection::Input);
        if (pin.role == pic::Role::Output) CHECK(pic::signals()[pin.signal].name == pin.function);
    }
    CHECK(pic::pin_function(PortLetter::A, 12) == "led3");
    CHECK(pic::pin_function(PortLetter::A, 10) == "led4");
    CHECK(pic::pin_function(PortLetter::B, 0).empty());
}

TEST_CASE("LEDs, pulses and other outputs follow their pins only while these are driven") {
    Heard heard;
    pic::Board board(quiet(), heard);
    board.driven(PortLetter::A, bit(12) | bit(6), 0, 10);  // latches set, pins still inputs
    CHECK(heard.changes.empty());
    board.driven(PortLetter::A, bit(12) | bit(6), bit(12), 20);
    board.driven(PortLetter::C, bit(1) | bit(2), 0xFFFF, 30);
    board.driven(PortLetter::A, bit(12), 0, 40);
    const std::vector<Heard::Change> expected{
        {pic::kLed + 3, 1, 20}, {pic::kLedFront, 1, 30}, {pic::kLedBody, 1, 30}, {pic::kLed + 3, 0, 40}};
    CHECK(heard.changes == expected);
    CHECK(board.signal(pic::kLedBody) == 1);
}

TEST_CASE("the digital inputs: selector, battery, remote, and lines at rest") {
    Heard heard;
    pic::BoardParameters parameters = quiet();
    parameters.selector = 10;
    pic::Board board(parameters, heard);
    CHECK((board.levels(PortLetter::G, 0) >> 6 & 15) == 10);
    CHECK((board.levels(PortLetter::G, 0) & (bit(2) | bit(3))) == (bit(2) | bit(3)));
    CHECK(board.levels(PortLetter::F, 0) == (bit(1) | bit(2) | bit(3) | bit(4) | bit(5) | bit(6)));
    CHECK(board.set_signal(pic::kBatteryLow, 1, 5) == PortLetter::F);
    CHECK((board.levels(PortLetter::F, 5) & bit(1)) == 0);
    CHECK(board.set_signal(pic::kBatteryVoltage, 3.41, 6) == PortLetter::F);
    CHECK((board.levels(PortLetter::F, 6) & bit(1)) != 0);
    CHECK_FALSE(board.set_signal(pic::kBatteryVoltage, 3.9, 7));
    CHECK(board.set_signal(pic::kBatteryVoltage, 3.39, 8) == PortLetter::F);
    CHECK(board.set_signal(pic::kSelector, 15, 9) == PortLetter::G);
    CHECK((board.levels(PortLetter::G, 0) >> 6 & 15) == 15);
    CHECK(board.set_signal(pic::kRemote, 0, 10) == PortLetter::F);
    CHECK_FALSE(board.set_signal(pic::kLed, 1, 11));  // outputs are the firmware's
    CHECK(board.signal(pic::kLed) == 0);
}

TEST_CASE("a proximity channel shows ambient minus what its own pulse line makes it reflect") {
    Heard heard;
    pic::Board board(quiet(), heard);
    board.set_signal(pic::kAmbient + 1, 3700, 0);
    board.set_signal(pic::kProximity + 1, 500, 0);
    board.set_signal(pic::kProximity + 5, 4000, 0);
    board.set_signal(pic::kProximity + 2, 900, 0);
    CHECK(counts(board, 9, 100) == 3700);
    board.driven(PortLetter::F, bit(8), bit(8), 1000);  // pulse 1: sensors 1 and 5
    CHECK(counts(board, 9, 1000) == 3700);
    CHECK(counts(board, 9, 1000 + 205) == 3700 - 250);  // half way after ln 2 time constants of 295 cycles
    CHECK(counts(board, 9, 1000 + 4424) == 3200);       // settled after 300 us
    CHECK(counts(board, 13, 1000 + 4424) == 0);         // saturates, never wraps
    CHECK(counts(board, 10, 1000 + 4424) == 3800);      // another pulse line's sensor
    board.driven(PortLetter::F, 0, bit(8), 5800);
    CHECK(counts(board, 9, 5800 + 4424) == 3700);
}

TEST_CASE("analog inputs: rest values, names that share an input, clipping, late questions") {
    Heard heard;
    pic::Board board(quiet(), heard);
    CHECK(counts(board, 2, 0) == 2048);
    CHECK(counts(board, 5, 0) == 2048);
    CHECK(counts(board, 7, 0) == 2848);
    CHECK(counts(board, 8, 0) == 3800);
    board.set_signal(pic::kAdc + 8, 1234, 50);
    CHECK(board.signal(pic::kAmbient) == 1234);
    CHECK(counts(board, 8, 50) == 1234);
    CHECK(counts(board, 8, 49) == 3800);
    board.set_signal(pic::kAdc + 3, 9999, 60);
    CHECK(board.signal(pic::kMicrophone + 1) == 4095);
    CHECK(counts(board, 3, 60) == 4095);
    board.set_signal(pic::kAcceleration, -1, 60);
    CHECK(counts(board, 5, 60) == 0);
    board.set_signal(pic::kAcceleration, std::nan(""), 70);
    CHECK(counts(board, 5, 70) == 0);
}

TEST_CASE("every code of the ADC can be reached, whether it truncates or rounds") {
    Heard heard;
    pic::Board board(quiet(), heard);
    for (int code = 0; code < 4096; code += 7) {
        board.set_signal(pic::kAdc, code, 0);
        CHECK(std::floor(board.analog(0, 0) * 4096) == code);
        CHECK(std::round(board.analog(0, 0) * 4096) == code);
    }
}

TEST_CASE("ADC noise has the standard deviation asked for, and a seed of its own") {
    Heard heard;
    pic::BoardParameters parameters;
    parameters.adc_noise_counts = 2.5;
    pic::Board board(parameters, heard), same(parameters, heard);
    parameters.name = "epuck2";
    pic::Board other(parameters, heard);
    double sum = 0, squares = 0;
    int differing = 0;
    constexpr int kSamples = 20000;
    for (dspic::Cycle now = 0; now < kSamples; ++now) {
        const double noise = counts(board, 8, now) - 3800;
        CHECK(counts(same, 8, now) - 3800 == noise);
        differing += counts(other, 8, now) - 3800 != noise;
        sum += noise;
        squares += noise * noise;
    }
    // Four standard errors: 2.5/sqrt(20000) for the mean, 2.5/sqrt(40000) for the deviation; rounding to
    // whole counts adds 1/12 to the variance.
    CHECK(std::abs(sum / kSamples) < 4 * 2.5 / std::sqrt(20000.0));
    CHECK(std::sqrt(squares / kSamples - 1.0 / 12) == Approx(2.5).margin(4 * 2.5 / std::sqrt(40000.0)));
    CHECK(differing > kSamples / 2);
}

TEST_CASE("wheel signals count the steps of both motors in the order in which they fall due") {
    Heard heard;
    pic::Board board(quiet(), heard);
    board.driven(PortLetter::D, 0x60, 0xFF, 1000);  // right: phase 0 to 1 is a step forward
    board.driven(PortLetter::D, 0x69, 0xFF, 1010);  // left: phase 0 to 3 is a step forward
    CHECK(heard.changes.empty());
    board.driven(PortLetter::D, 0x00, 0xFF, 5000);
    const std::vector<Heard::Change> expected{{pic::kWheelRight, 1, 1030}, {pic::kWheelLeft, 1, 1040}};
    CHECK(heard.changes == expected);
    board.driven(PortLetter::D, 0xA5, 0xFF, 6000);
    board.settle(6029);
    CHECK(heard.changes.size() == 2);
    board.settle(6030);  // left: 3 to 2, forward; right: 1 to 0, backward
    CHECK(board.signal(pic::kWheelLeft) == 2);
    CHECK(board.signal(pic::kWheelRight) == 0);
}

TEST_CASE("coils that are not driven carry no current") {
    Heard heard;
    pic::Board board(quiet(), heard);
    board.driven(PortLetter::D, 0x69, 0x00, 1000);
    board.settle(100000);
    CHECK(heard.changes.empty());
    CHECK(board.left_motor().pattern() == 0);
}

TEST_CASE("the battery's voltage is at AN7 of board revision 1.3, and no accelerometer at AN5 to AN7") {
    pic::BoardParameters parameters = quiet();
    parameters.revision = pic::Revision::Rev13;
    Heard heard;
    pic::Board board(parameters, heard);
    board.set_signal(pic::kAcceleration + 2, 1234, 5);
    CHECK(counts(board, 5, 10) == 0);
    CHECK(counts(board, 6, 10) == 0);
    for (const auto& [volts, raw] : {std::pair{3.4, 2070}, {4.2, 2560}, {3.8, 2315}}) {
        board.set_signal(pic::kBatteryVoltage, volts, 20);
        CHECK(std::abs(counts(board, 7, 30) - raw) <= 1);
    }
    board.set_sag(0.5, 40);
    CHECK(std::abs(counts(board, 7, 50) - (2315 - 306)) <= 1);
    CHECK(board.signal(pic::kBatteryLow) == 1);
    CHECK(counts(board, 2, 50) == 2048);
}
