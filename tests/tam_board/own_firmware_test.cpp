// The project's own firmware for the TAM (firmware/tam), on the board.
#include "tests/tam_board/booth.h"

#include <catch2/catch.hpp>

#include <random>

using namespace puckloop;
using namespace puckloop::tam;
using namespace puckloop::tam::test;

namespace {

/// One that has found its coordinator.
struct Joined : Booth {
    Joined() : Booth(TAM_FIRMWARE) { run_until(cosim::kSecond); }
};

bool says(const XBeeBytes& report, int red, int green, int blue, bool present, int robot) {
    return report.size() == 8 && report[0] == 0 && report[1] == red && report[2] == green &&
           report[3] == blue && report[4] == present && report[7] == robot;
}

}  // namespace

TEST_CASE("the own TAM firmware joins the network of its switches, finds the coordinator and reports") {
    const bool old_status = GENERATE(true, false);
    Booth booth(TAM_FIRMWARE);
    booth.found_status = old_status ? 0x40 : 0x00;
    booth.rig.board.set_signal(kNetworkSwitch, 0);  // XBEE_NET_0 closed: network 01B3
    booth.run_until(12 * cosim::kSecond);
    REQUIRE(booth.sent.size() >= 3);
    CHECK(std::get<XBeeAt>(booth.sent[0].second) == XBeeAt{.command = {'I', 'D'}, .value = {0x01, 0xB3}});
    CHECK(std::get<XBeeAt>(booth.sent[1].second) ==
          XBeeAt{.command = {'D', 'N'}, .value = {'C', 'O', 'O', 'R', 'D'}});
    const auto reports = booth.reports();
    REQUIRE(reports.size() == 2);
    CHECK(reports[0].first < cosim::kSecond);
    CHECK(ms(reports[1].first - reports[0].first) == Approx(10'000).epsilon(0.001));
    CHECK(says(reports[0].second, 0, 0, 0, false, 0));
    const int millivolts = reports[1].second[5] | reports[1].second[6] << 8;
    CHECK(millivolts == Approx(3700).margin(20));  // the original's 33 mV a count gives 3795
    CHECK(booth.rig.board.signal(kNetworkLed) == 1.0);
    CHECK(booth.console.find("coordinator found") != std::string::npos);
    CHECK(std::get<XBeeTx>(booth.sent[2].second).to == 0x0013A200408A3107);
}

TEST_CASE("a robot in the own TAM is reported within half a second, colours are shown and reported") {
    Joined booth;
    const Time enters = booth.rig.board.now();
    booth.rig.board.set_signal(kBarrier + 1, 1.0);
    booth.run_until(enters + cosim::kSecond);
    REQUIRE(booth.reports().size() == 2);
    CHECK(says(booth.reports()[1].second, 0, 0, 0, true, 0));
    CHECK(ms(booth.reports()[1].first - enters) < 480);
    booth.command({0x0A, 0x19, 0x00, 0x0C});
    booth.run_until(booth.rig.board.now() + 200 * kMs);
    REQUIRE(booth.reports().size() == 3);
    CHECK(says(booth.reports()[2].second, 0x19, 0x00, 0x0C, true, 0));
    for (const int red : {1, 4, 7})
        CHECK(booth.rig.board.signal(static_cast<SignalId>(kLed + red)) == 0x10 / 256.0);
    for (const int blue : {2, 5, 8, 13})
        CHECK(booth.rig.board.signal(static_cast<SignalId>(kLed + blue)) == 0x0C / 256.0);
    for (const int green : {3, 6, 9, 14})
        CHECK(booth.rig.board.signal(static_cast<SignalId>(kLed + green)) == 0.0);
    booth.rig.board.set_signal(kBarrier, 1.0);  // half out: neither in nor gone
    booth.run_until(booth.rig.board.now() + cosim::kSecond);
    CHECK(booth.reports().size() == 3);
    booth.rig.board.set_signal(kBarrier, 0.0);
    booth.rig.board.set_signal(kBarrier + 1, 0.0);
    booth.run_until(booth.rig.board.now() + cosim::kSecond);
    CHECK(says(booth.reports().back().second, 0x19, 0x00, 0x0C, false, 0));
}

TEST_CASE("words cross between the own TAM and a robot") {
    Joined booth;
    booth.rig.board.set_signal(kBarrier + 1, 1.0);
    booth.command({0x0C, 0xA5});
    booth.run_until(booth.rig.board.now() + cosim::kSecond);
    booth.rig.changes.clear();
    booth.changes_seen = 0;
    booth.run_until_word();
    booth.run_until(booth.rig.board.now() + 50 * kMs);
    const auto light = booth.rig.of(kProximityEmit);
    std::vector<Time> edges;
    for (const auto& change : light)
        edges.push_back(change.at - light.front().at);
    const std::vector<Time> expected = ircom_edges(0xA5);
    REQUIRE(edges.size() >= expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
        CHECK(std::abs(ms(edges[i] - expected[i])) < 0.02);

    std::mt19937_64 random(3);
    for (int round = 0; round < 12; ++round) {
        const auto word = static_cast<std::uint8_t>(random());
        const double stretch = 0.98 + 0.04 * static_cast<double>(random() % 100) / 100;
        booth.run_until_word();
        const Time begin = booth.rig.board.now() + 60 * kMs;
        booth.hear(word, begin, stretch);
        booth.run_until(begin + 150 * kMs);
        CAPTURE(int{word}, stretch);
        CHECK(int{booth.reports().back().second[7]} == word);
    }
}

TEST_CASE("the own TAM goes on behind damaged frames, and looks anew for a coordinator that is gone") {
    Joined booth;
    // A frame cut short, one with a wrong check, noise: the command behind them is obeyed.
    const auto bytes = [&](const XBeeBytes& raw) {
        for (const std::uint8_t byte : raw) {
            booth.line_free = std::max(booth.line_free, booth.rig.board.now()) + kByteTime;
            booth.to_booth.emplace_back(booth.line_free - kBit, byte);
        }
    };
    bytes({0x7E, 0x00, 0x10, 0x90, 0x01});
    bytes({0x7E, 0x00, 0x02, 0x8A, 0x00, 0x00});
    bytes({0x55, 0x13, 0x7D});
    bytes({0x7E, 0x00, 0x00, 0x7E, 0xFF, 0xFF});
    booth.command({0x0A, 0x01, 0x02, 0x03});
    booth.run_until(booth.rig.board.now() + 200 * kMs);
    CHECK(says(booth.reports().back().second, 1, 2, 3, false, 0));

    booth.acknowledges = false;
    booth.sent.clear();
    booth.command({0x0A, 0x04, 0x05, 0x06});
    booth.run_until(booth.rig.board.now() + 15 * cosim::kSecond);
    int searches = 0;
    for (const auto& [at, message] : booth.sent)
        if (const auto* command = std::get_if<XBeeAt>(&message))
            searches += command->command == XBeeCommand{'D', 'N'};
    CHECK(searches >= 1);
    booth.acknowledges = true;
    booth.run_until(booth.rig.board.now() + 3 * cosim::kSecond);
    CHECK(says(booth.reports().back().second, 4, 5, 6, false, 0));
}

TEST_CASE("the own TAM comes up without a radio module, and switches off when asked or empty") {
    Booth booth(TAM_FIRMWARE);
    booth.answers = false;
    booth.run_until(4 * cosim::kSecond);
    CHECK(booth.sent.size() >= 2);  // it asks all the same
    booth.answers = true;
    booth.run_until(9 * cosim::kSecond);
    CHECK(booth.reports().size() >= 1);
    SECTION("asked") {
        booth.command({0x0D});
    }
    SECTION("empty") {
        booth.rig.board.set_signal(kBattery, 2.6);
    }
    booth.run_until(booth.rig.board.now() + 2 * cosim::kSecond);
    CHECK_FALSE(booth.rig.board.powered());
    CHECK(booth.rig.of(kLed + 1).empty());
}
