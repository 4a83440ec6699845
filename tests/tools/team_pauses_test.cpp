// Pause times of teams: read from a trace, summarised, drawn, and made by emulated robots in a short run.

#include "protocols/network/ip_packet.h"
#include "reproductions/pause_times.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <string>

using namespace puckloop;
using namespace puckloop::tools;

namespace {

constexpr cosim::Time kBit = cosim::kSecond / 115200;

/// A line on a robot's UART, byte behind byte from `begin` on; when its last bit is over.
cosim::Time line(TeamTrace& team, int robot, const char* node, const std::string& text, cosim::Time begin) {
    cosim::TraceRow row;
    row.link = "robot" + std::to_string(robot) + ".uart";
    row.from = "robot" + std::to_string(robot) + node;
    for (const char character : text) {
        cosim::UartFrame frame;
        frame.data = static_cast<unsigned char>(character);
        frame.start = begin;
        frame.bit_period = kBit;
        begin += 10 * kBit;
        row.time = begin;
        row.payload = frame;
        team.add(row);
    }
    return begin;
}

/// A segment of the manager to robot `to` (by its number).
void segment(TeamTrace& team, bool arrives, int to, const std::string& data, cosim::Time time) {
    constexpr protocols::IpAddress kManager = 0x0a0000fe, kNetwork = 0x0a000000;
    const protocols::IpAddress address = kNetwork + static_cast<protocols::IpAddress>(to);
    protocols::TcpSegment tcp{.from_port = 7700, .to_port = 5000, .flags = protocols::kAck, .data = data};
    cosim::TraceRow row;
    row.time = time;
    row.link = arrives ? "robot" + std::to_string(to - 1) + ".network" : "manager.network";
    row.from = arrives ? "network" : "manager.linux";
    const auto octets = protocols::encode({.from = kManager,
                                           .to = address,
                                           .protocol = protocols::kTcp,
                                           .payload = protocols::encode_tcp(tcp, kManager, address)});
    row.payload = cosim::Packet{.octets = cosim::Octets(octets)};
    team.add(row);
}

}  // namespace

TEST_CASE("a message to all is followed through the trace to each robot", "[pauses]") {
    TeamTrace team(3, "manager");
    using cosim::kMillisecond;
    const cosim::Time ended = line(team, 1, ".pic", "9999 hello 00007\r", 5000 * kMillisecond);
    line(team, 2, ".pic", "0001 hello 00007\r", 5000 * kMillisecond);  // to one
    segment(team, false, 1, "2 hello 00007\r", ended + kMillisecond);
    segment(team, false, 1, "2 hello 00007\r", ended + 90 * kMillisecond);  // again
    segment(team, true, 1, "3 other\r2 hello 00007\r", ended + 3 * kMillisecond);
    const cosim::Time received = line(team, 0, ".linux", "2 hello 00007\r", ended + 4 * kMillisecond);
    line(team, 2, ".linux", "9 hello 00007\r2 hello\r", ended);  // of nobody; another one
    REQUIRE(team.messages().size() == 1);
    const TeamMessage& message = team.messages()[0];
    CHECK(message.from == 1);
    CHECK(message.data == "hello 00007");
    CHECK(message.begun == 5.0);
    CHECK(message.ended == Approx(cosim::to_seconds(ended)));
    CHECK(message.arrivals[0].received == Approx(cosim::to_seconds(received)));
    CHECK(message.arrivals[2].received < 0);

    const auto pauses = pauses_of(team.messages(), 4, 6);
    REQUIRE(pauses.size() == 2);
    CHECK(pauses[0].to == 0);
    const double uart_out = 17 * 10 / 115.2, uart_in = 14 * 10 / 115.2;  // ms
    CHECK(pauses[0].pause == Approx(uart_out + 4 + uart_in).epsilon(1e-6));
    CHECK(pauses[0].parts[0] == Approx(uart_out).epsilon(1e-6));
    CHECK(pauses[0].parts[1] == Approx(1).epsilon(1e-6));
    CHECK(pauses[0].parts[2] == Approx(2).epsilon(1e-6));
    CHECK(pauses[0].parts[3] == Approx(1 + uart_in).epsilon(1e-6));
    CHECK(pauses[1].to == 2);
    CHECK(pauses[1].pause < 0);
    CHECK(pauses_of(team.messages(), 5.001, 6).empty());
    CHECK(pauses_of(team.messages(), 4, 5).empty());
    CHECK(pauses_csv("f", 3, 0, pauses).find("f,3,0,2,3,5.000000,lost,") != std::string::npos);
}

TEST_CASE("a team's pauses are counted, and their growth is the slope of medians", "[pauses]") {
    std::vector<Pause> pauses;
    for (int i = 1; i <= 100; ++i)
        pauses.push_back({0, 1, 5.0, static_cast<double>(i), {1, 2, 3, static_cast<double>(i) - 6}});
    pauses.push_back({0, 1, 5.0});
    TeamPauses team = summary_of(2, 1, pauses);
    CHECK(team.packets == 101);
    CHECK(team.lost == 1);
    CHECK(team.median == Approx(50.5));
    CHECK(team.quarter == Approx(25.75));
    CHECK(team.mean == Approx(50.5));
    CHECK(team.parts[2] == Approx(3));
    CHECK(team.parts[3] == Approx(44.5));
    CHECK(published_pause(2) == 157);
    CHECK(published_pause(14) == 172);
    CHECK(published_pause(8) == Approx(164.5));
    TeamPauses more = team;
    more.robots = 12;
    more.median += 20;
    CHECK(growth_of({team, more}) == Approx(2.0));
    CHECK(growth_of({team}) == 0);
    const std::string table = pause_table({"f", {team, more}});
    CHECK(table.find("2 of 202 packets lost (published: 0 of 2000)") != std::string::npos);
    CHECK(table.find("each further robot adds 2.00 ms to the median (published: 1.25 ms)") !=
          std::string::npos);
    CHECK(pause_picture({{"f", {team, more}}, {"g", {team}}}, "words").ends_with("</svg>\n"));
    CHECK(summary_of(3, 1, {}).median == 0);
}

TEST_CASE("emulated robots say hello over UART, forwarder, radio and manager", "[pauses]") {
    TeamSpec spec;
    spec.folder = tests::scratch_path("team");
    spec.firmware = PUCKLOOP_SOURCE "/firmware/network/network.hex";
    spec.robots = 3;
    spec.seconds = 12;
    spec.seed = Catch::rngSeed();
    const auto pauses = run_team(spec);
    // Each robot's hello within the five seconds that count, to both of the others.
    REQUIRE(pauses.size() == 6);
    for (const Pause& one : pauses) {
        INFO(one.from << " to " << one.to);
        // 17 characters there and 14 back take 2.69 ms, each way of packets by radio and wire some 0.5 ms.
        CHECK(one.pause > 3.7);
        CHECK(one.pause < 20);
        CHECK(one.parts[0] == Approx(17 * 10 / 115.2).epsilon(0.02));
        CHECK(one.parts[1] > 0.5);
        CHECK(one.parts[2] > 0.5);
        CHECK(one.parts[0] + one.parts[1] + one.parts[2] + one.parts[3] == Approx(one.pause));
    }
    // The same once more.
    const auto again = run_team(spec);
    REQUIRE(again.size() == pauses.size());
    for (std::size_t i = 0; i < pauses.size(); ++i)
        CHECK(again[i].pause == pauses[i].pause);
    spec.firmware = PUCKLOOP_SOURCE "/firmware/sound/sound.hex";
    CHECK_THROWS_WITH(run_team(spec), Catch::Contains("no robot sent a message"));
}
