// The range-and-bearing board's supply: the robot's battery, the regulator, and the chip's brown-out reset.

#include "emu/rab_board/rab_node.h"
#include "tests/kit/board_faults.h"
#include "tests/kit/node_under_test.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

using namespace puckloop;
using namespace puckloop::rab;
using cosim::kMillisecond;
using cosim::Message;
using cosim::Time;

namespace {

struct Nobody : BoardListener {
    void signal_changed(SignalId, double, Time) override {}
    void emitters_changed(std::uint16_t, Time) override {}
    void uart_sent(int, const cosim::UartFrame&) override {}
    void i2c_answer(const cosim::I2cPhase&, Time) override {}
    void i2c_phase(int, const cosim::I2cPhase&) override {}
};

/// Each start lights the LED; 0x0C00 has RCON, 0x0C02 counts them. FPWRT as given.
std::string starts(unsigned fpwrt) {
    return fmt::format(R"(
        goto main
        .org 0x200
main:   mov RCON, w1
        mov w1, 0x0C00
        inc 0x0C02
        clr RCON
        bclr TRISC, #13
        bset LATC, #13
here:   bra here
        .org 0xF8000C
        .pword {:#x}
)",
                       0xFFF8 | fpwrt);
}

struct Supplied {
    RabNode node;
    std::vector<Message> out;

    explicit Supplied(unsigned fpwrt, std::vector<cosim::CarriedFault> faults = {})
        : node(tests::assembled(dspic::dspic33fj256gp710(), starts(fpwrt)), with(std::move(faults))) {}
    static RabNodeOptions with(std::vector<cosim::CarriedFault> faults) {
        RabNodeOptions options;
        options.faults = std::move(faults);
        return options;
    }
    /// Signals by their times, then on to `until`.
    void run(const std::vector<std::pair<Time, Message>>& signals, Time until) {
        std::vector<Message> inbox;
        for (const auto& [time, message] : signals)
            inbox.push_back(message);
        node.advance(until, inbox, out);
    }
    static std::pair<Time, Message> set(SignalId id, double value, Time at) {
        const auto port = id == kBattery ? RabNode::kWorld : RabNode::kIr;
        return {at, Message{at, port, cosim::Signal{id, value}}};
    }
    int rcon() { return node.chip().peek_data(0x0C00); }
    int count() { return node.chip().peek_data(0x0C02); }
};

}  // namespace

TEST_CASE("the board's supply follows the battery from 3.4 V down, and what a load leaves of it",
          "[supply]") {
    Nobody nobody;
    Board board({}, nobody);
    CHECK(board.supply() == 3.3);
    board.set_signal(kBattery, 3.0, 0);
    CHECK(board.supply() == Approx(2.9));
    board.set_sag(0.4);
    CHECK(board.supply() == Approx(2.5));
    board.set_battery(3.7);
    CHECK(board.supply() == Approx(3.2));
    board.set_signal(kVdd, 2.2, 0);
    CHECK(board.supply() == 2.2);
}

TEST_CASE("a dip below 2.475 V resets the board, which starts again by FPWRT", "[supply]") {
    constexpr Time kPowerUp[] = {0, 2, 4, 8, 16, 32, 64, 128};
    for (unsigned fpwrt = 0; fpwrt < 8; ++fpwrt)
        for (const SignalId id : {kBattery, kVdd}) {
            CAPTURE(fpwrt, id);
            const double dropout = id == kBattery ? 0.1 : 0.0;
            Supplied s(fpwrt);
            s.run({Supplied::set(id, 2.48 + dropout, 5 * kMillisecond)}, 10 * kMillisecond);
            CHECK(s.count() == 1);
            const Time back = 30 * kMillisecond, up = back + kPowerUp[fpwrt] * kMillisecond;
            s.run({Supplied::set(id, 2.47 + dropout, 20 * kMillisecond),
                   Supplied::set(id, 3.3 + dropout, back)},
                  up);
            CHECK(s.count() == 1);
            s.run({}, up + kMillisecond);
            CHECK(s.count() == 2);
            CHECK((s.rcon() & 0xC0DF) == 2);  // BOR alone
            // Deep enough, it is a power-on.
            s.run({Supplied::set(id, 1.0, 300 * kMillisecond),
                   Supplied::set(id, 3.3 + dropout, 301 * kMillisecond)},
                  500 * kMillisecond);
            CHECK(s.count() == 3);
            CHECK((s.rcon() & 0xC0DF) == 3);
        }
}

TEST_CASE("sag and battery faults on the range-and-bearing board are its supply's", "[supply]") {
    cosim::FaultSpec sag = tests::board_fault("sag").set("volts", 1.4);  // of 3.9 V: 2.4 V of supply
    sag.begin = 10 * kMillisecond;
    sag.end = 20 * kMillisecond;
    Supplied s(2, {tests::carried(sag)});  // 4 ms
    s.run({}, 23 * kMillisecond);
    CHECK(s.count() == 1);
    s.run({}, 25 * kMillisecond);
    CHECK(s.count() == 2);
    CHECK((s.rcon() & 0xC0DF) == 2);
    cosim::FaultSpec battery = tests::board_fault("battery").set("profile", "0 s 3.6 V, 20 ms 2.0 V");
    battery.begin = 10 * kMillisecond;
    battery.end = 40 * kMillisecond;
    Supplied drained(2, {tests::carried(battery)});
    drained.run({}, 43 * kMillisecond);
    CHECK(drained.count() == 1);
    drained.run({}, 45 * kMillisecond);
    CHECK(drained.count() == 2);
}
