// The board's supply and the chip's low-voltage detector on it.

#include "emu/pic/board.h"
#include "emu/pic/pic_node.h"
#include "tests/kit/node_under_test.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

using namespace puckloop;
using cosim::kMillisecond;

namespace {

struct Nobody : pic::BoardListener {
    void signal_changed(pic::SignalId, double, dspic::Cycle) override {}
    void uart_sent(int, const cosim::UartFrame&) override {}
    void i2c_phase(int, const cosim::I2cPhase&) override {}
};

/// Waits for the band gap, then lights LED 0; the interrupt of the detector, at LVDL = 7 (3.0 to 3.18 V),
/// LED 1.
const std::string kWatcher = R"(
        goto main
        .org 0x0068
        .pword low
        .org 0x0100
main:   mov #0x0900, w15
        mov #0x27f0, w0
        mov w0, SPLIM
        bclr TRISA, #6
        bclr TRISA, #7
        mov #0x1700, w0
        mov w0, RCON
wait:   btss RCON, #13
        bra wait
        bset LATA, #6
        bclr IFS2, #10
        bset IEC2, #10
idle:   pwrsav #1
        bra idle
low:    bclr IFS2, #10
        bset LATA, #7
        retfie
)";

/// LED 0 after power-up, LED 1 after a brown-out (FBORPOR: below 2.7 V, 64 ms of power-up timer).
const std::string kBrownOut = R"(
        goto main
        .org 0x0100
main:   bclr TRISA, #6
        bclr TRISA, #7
        btsc RCON, #0
        bset LATA, #6
        btss RCON, #0
        btss RCON, #1
        bra done
        bset LATA, #7
done:   clr RCON
here:   bra here
        .org 0xF80004
        .pword 0xFF87A3
)";

/// When each LED went on; 0: never.
std::vector<cosim::Time> lit(pic::PicNode& node, std::vector<cosim::Message> inbox, cosim::Time until) {
    std::vector<cosim::Message> out;
    node.advance(until, inbox, out);
    std::vector<cosim::Time> times(2, 0);
    for (const auto& message : out)
        if (const auto* signal = std::get_if<cosim::Signal>(&message.payload))
            for (std::size_t led = 0; led < times.size(); ++led)
                if (signal->id == pic::kLed + led && signal->value > 0) times[led] = message.time;
    return times;
}

}  // namespace

TEST_CASE("the supply is the regulator's until the battery cannot hold it", "[lvd]") {
    Nobody nobody;
    pic::Board board({}, nobody);
    CHECK(board.supply() == Approx(3.3));
    board.set_signal(pic::kBatteryVoltage, 3.2, 10);
    CHECK(board.supply() == Approx(3.1));
    board.set_sag(0.5, 20);
    CHECK(board.supply() == Approx(2.6));
}

TEST_CASE("a program that polls BGST goes on, and is interrupted when the battery gives out", "[lvd]") {
    pic::PicNodeOptions options;
    options.board.name = "robot";
    options.i2c_linked = false;
    pic::PicNode node(tests::assembled(dspic::dspic30f6014a(), kWatcher), options);
    const auto battery = [](double volts, cosim::Time time) {
        return cosim::Message{time, pic::PicNode::kWorld, cosim::Signal{pic::kBatteryVoltage, volts}};
    };
    const auto boot = lit(node, {battery(3.25, 5 * kMillisecond)}, 10 * kMillisecond);
    CHECK(boot[0] > 0);
    CHECK(boot[0] < kMillisecond);
    CHECK(boot[1] == 0);
    const auto low = lit(node, {battery(3.1, 20 * kMillisecond)}, 30 * kMillisecond);
    CHECK(low[1] >= 20 * kMillisecond);
    CHECK(low[1] < 20 * kMillisecond + cosim::kMicrosecond);
}

TEST_CASE("a battery that gives out for a moment is a brown-out reset, if the image asks for it",
          "[supply]") {
    pic::PicNodeOptions options;
    options.board.name = "robot";
    options.i2c_linked = false;
    pic::PicNode node(tests::assembled(dspic::dspic30f6014a(), kBrownOut), options);
    const auto battery = [](double volts, cosim::Time time) {
        return cosim::Message{time, pic::PicNode::kWorld, cosim::Signal{pic::kBatteryVoltage, volts}};
    };
    const auto boot = lit(node, {battery(2.9, 5 * kMillisecond)}, 10 * kMillisecond);
    CHECK(boot[0] > 0);
    CHECK(boot[1] == 0);
    // The regulator needs 0.1 V.
    const auto dip =
        lit(node, {battery(2.79, 20 * kMillisecond), battery(3.7, 25 * kMillisecond)}, 200 * kMillisecond);
    CHECK(dip[0] == 0);
    CHECK(dip[1] > 89 * kMillisecond);
    CHECK(dip[1] < 90 * kMillisecond);
}
