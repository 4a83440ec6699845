// Walls between radios, and the mesh: ways, hops, changes of ways, packets for all.

#include "base/error.h"
#include "base/random.h"
#include "tests/network/wifi_kit.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <sstream>

using namespace puckloop;
using namespace puckloop::tests;
using cosim::kMillisecond;
using wifi::Obstacle;
using wifi::Position;

namespace {

Obstacle box(double x, double y, double length, double width, double heading = 0) {
    return {.name = "box", .x = x, .y = y, .heading = heading, .length = length, .width = width, .loss = 5};
}

/// Stations in a row, `apart` m, of which 54 Mbit/s reach 16.9 m, 6 Mbit/s 62 m (3 dB above -82 dBm).
wifi::WifiSpec row(std::size_t count, double apart) {
    wifi::WifiSpec spec;
    spec.settings.shadowing = 0;
    spec.settings.mesh = true;
    spec.settings.carrier_sense = -100;  // all hear each other: nobody is hidden
    spec.latency = kMillisecond;
    for (std::size_t i = 0; i < count; ++i)
        spec.stations.push_back(
            {.computer = {std::string(1, static_cast<char>('a' + i)), fmt::format("10.0.0.{}", i + 1)},
             .at = {apart * static_cast<double>(i), 0}});
    return spec;
}

struct Came {
    std::vector<std::string> lines{};  ///< "b one", by time
    std::vector<cosim::Time> times{};
    nlohmann::json report{};
};

Came carry(const wifi::WifiSpec& spec, const std::vector<cosim::Message>& sent, cosim::Time end,
           cosim::Time step = 10 * kMillisecond) {
    wifi::WifiNode node(spec);
    std::vector<cosim::Message> outbox;
    std::size_t next = 0;
    for (cosim::Time until = step; until <= end; until += step) {
        std::vector<cosim::Message> inbox;
        while (next < sent.size() && sent[next].time < until)
            inbox.push_back(sent[next++]);
        node.advance(until, inbox, outbox);
    }
    std::stable_sort(outbox.begin(), outbox.end(),
                     [](const auto& a, const auto& b) { return a.time < b.time; });
    Came came;
    for (const cosim::Message& message : outbox) {
        const auto read = protocols::decode_ip(std::get<cosim::Packet>(message.payload).octets.view());
        came.lines.push_back(fmt::format("{} {}", static_cast<char>('a' + message.port),
                                         protocols::decode_udp(*read)->data.c_str()));
        came.times.push_back(message.time);
    }
    came.report = nlohmann::json::parse(node.finish());
    return came;
}

std::string text_in(const std::string& file) {
    std::ifstream in(file);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

using Lines = std::vector<std::string>;

}  // namespace

TEST_CASE("whatever the line crosses takes its loss", "[wifi]") {
    const wifi::Obstacles wall({box(0, 0, 0.02, 2)}, 0, 0);
    CHECK(wall.loss_between({-1, 0}, {1, 0}) == 5);
    CHECK(wall.loss_between({1, 0.9}, {-1, 0.9}) == 5);
    CHECK(wall.loss_between({-1, 1.01}, {1, 1.01}) == 0);  // past its end
    CHECK(wall.loss_between({-1, 0}, {-0.02, 0}) == 0);    // before it
    CHECK(wall.loss_between({-1, 0.5}, {1, 1.6}) == 0);    // round its end
    CHECK(wall.loss_between({-1, 0.5}, {1, 1.4}) == 5);
    CHECK(wall.loss_between({0.05, -5}, {0.05, 5}) == 0);  // beside it
    CHECK(wall.loss_between({-1, 0}, {0, 0}) == 5);        // into it
    // Turned by 90 degrees, and by 45.
    const wifi::Obstacles turned({box(0, 0, 0.02, 2, 1.5707963267948966)}, 0, 0);
    CHECK(turned.loss_between({-2, 0.1}, {2, 0.1}) == 0);
    CHECK(turned.loss_between({0.5, -1}, {0.5, 1}) == 5);
    const wifi::Obstacles diagonal({box(1, 1, 1, 1, 0.7853981633974483)}, 0, 0);
    CHECK(diagonal.loss_between({0.35, -1}, {0.35, 3}) == 5);
    CHECK(diagonal.loss_between({0.25, -1}, {0.25, 3}) == 0);
    const wifi::Obstacles cylinder({{.name = "can", .box = false, .x = 1, .length = 0.2, .loss = 3}}, 0, 0);
    CHECK(cylinder.loss_between({0, 0}, {2, 0}) == 3);
    CHECK(cylinder.loss_between({0, 0.11}, {2, 0.11}) == 0);
    CHECK(cylinder.loss_between({0, 0}, {0.8, 0}) == 0);
    // Two of them add up; the loss is the same both ways.
    const wifi::Obstacles two({box(0, 0, 0.02, 2), box(0.5, 0, 0.02, 2)}, 0, 0);
    CHECK(two.loss_between({-1, 0}, {1, 0}) == 10);
    CHECK(two.loss_between({1, 0}, {-1, 0}) == 10);
    CHECK(wifi::Obstacles({}, 0, 0).loss_between({-1, 0}, {1, 0}) == 0);
}

TEST_CASE("what a line crosses is what points of it are in (seeded)", "[wifi]") {
    RandomStream random(42, "obstacles");
    const auto drawn = [&](double low, double high) { return low + (high - low) * random.uniform(); };
    int crossed = 0;
    for (int i = 0; i < 2000; ++i) {
        Obstacle one = box(drawn(-2, 2), drawn(-2, 2), drawn(0.1, 2), drawn(0.1, 2), drawn(-4, 4));
        one.box = i % 3 != 0;
        const Position a{drawn(-3, 3), drawn(-3, 3)}, b{drawn(-3, 3), drawn(-3, 3)};
        double deepest = -1e9;  // m inside
        for (int k = 0; k <= 4000; ++k) {
            const double x = a[0] + (b[0] - a[0]) * k / 4000 - one.x,
                         y = a[1] + (b[1] - a[1]) * k / 4000 - one.y;
            const double along = std::cos(one.heading) * x + std::sin(one.heading) * y,
                         beside = std::cos(one.heading) * y - std::sin(one.heading) * x;
            const double inside =
                one.box ? std::min(one.length / 2 - std::abs(along), one.width / 2 - std::abs(beside))
                        : one.length / 2 - std::hypot(x, y);
            deepest = std::max(deepest, inside);
        }
        const bool crosses = wifi::Obstacles({one}, 0, 0).loss_between(a, b) > 0;
        INFO(i << ": " << deepest << " m inside");
        if (deepest > 0) CHECK(crosses);
        if (deepest < -0.005) CHECK_FALSE(crosses);  // points are up to 2 mm apart
        crossed += crosses ? 1 : 0;
    }
    CHECK(crossed > 300);
    CHECK(crossed < 1700);
}

TEST_CASE("walls follow what the world reports of them", "[wifi]") {
    Obstacle crate = box(0, 0, 1, 1);
    crate.pose = 3;
    crate.away = 7;
    Obstacle wall = box(0, 5, 4, 0.1);
    wall.shape = 8;
    wifi::Obstacles all({crate, wall}, 8, 2.0);
    CHECK(all.loss_between({-1, 0}, {1, 0}) == 5);
    CHECK_FALSE(all.take(0, 1.0));
    CHECK_FALSE(all.take(6, 1.0));
    CHECK(all.take(4, 3.0));  // y
    CHECK(all.loss_between({-1, 0}, {1, 0}) == 0);
    CHECK(all.loss_between({-1, 3}, {1, 3}) == 5);
    CHECK(all.take(7, 1.0));
    CHECK(all.loss_between({-1, 3}, {1, 3}) == 0);
    CHECK(all.loss_between({0, 4}, {0, 6}) == 5);
    CHECK(all.take(8 + 6, 0.0));  // its height
    CHECK(all.loss_between({0, 4}, {0, 6}) == 0);
    // One that was added: a box at (9, 0), 2 m by 0.2 m, which is there once it has a height.
    for (const auto& [k, value] : {std::pair(0, 1.0), {1, 9.0}, {2, 0.0}, {3, 0.0}, {4, 1.0}, {5, 0.1}})
        CHECK(all.take(8 + 8 + k, value));
    CHECK(all.loss_between({9, -1}, {9, 1}) == 0);
    CHECK(all.take(8 + 8 + 6, 0.1));
    CHECK(all.loss_between({9, -1}, {9, 1}) == 2);
    CHECK(all.loss_between({10.1, -1}, {10.1, 1}) == 0);
}

TEST_CASE("a wall weakens what arrives, and may hide a station", "[wifi]") {
    wifi::WifiSpec spec = row(2, 20);
    spec.settings.mesh = false;
    const std::vector<cosim::Message> sent{packet(0, 0, kFirst + 1, "x")};
    CHECK(carry(spec, sent, 100 * kMillisecond).lines == Lines{"b x"});
    // -64.2 dBm without; 6 Mbit/s need -82.
    for (const auto& [loss, reads] : {std::pair(13.0, true), {25.0, false}}) {
        wifi::WifiSpec behind = spec;
        behind.obstacles = {box(10, 0, 0.2, 3)};
        behind.obstacles[0].loss = loss;
        INFO(loss);
        CHECK(carry(behind, sent, 100 * kMillisecond).lines.size() == (reads ? 1 : 0));
    }
    wifi::Medium medium(spec.settings, {"a", "b"}, {{0, 0}, {20, 0}}, 1);
    const double clear = medium.received_dbm(0, 1);
    medium.set_obstacles({{box(10, 0, 0.2, 3)}, 0, 0});
    CHECK(medium.received_dbm(0, 1) == Approx(clear - 5));
    CHECK(medium.received_dbm(1, 0) == Approx(clear - 5));
}

TEST_CASE("a mesh carries packets over stations between", "[wifi][mesh]") {
    // 40 m apart: each reaches the next one only.
    wifi::WifiSpec spec = row(5, 40);
    spec.routes_csv = "mesh_routes.csv";
    const std::vector<cosim::Message> sent{packet(10 * kMillisecond, 0, kFirst + 4, "far"),
                                           packet(200 * kMillisecond, 3, kFirst + 2, "near"),
                                           packet(300 * kMillisecond, 1, kFirst + 9, "nobody")};
    const Came came = carry(spec, sent, cosim::kSecond);
    CHECK(came.lines == Lines{"e far", "c near"});
    const auto& mesh = came.report["mesh"];
    CHECK(mesh["passed_on"] == nlohmann::json::parse(R"({"a":0,"b":1,"c":1,"d":1,"e":0})"));
    CHECK(mesh["route_changes"] == 0);
    CHECK(mesh["no_way"] == 0);
    const std::string routes = text_in(spec.routes_csv);
    CHECK(routes.starts_with("time_s,from,to,next,hops\n0.000000,a,b,b,1\n0.000000,a,c,b,2\n"));
    CHECK(routes.find("0.000000,e,a,d,4\n") != std::string::npos);
    // Four hops take four times the air of one.
    const cosim::Time one = came.times[1] - 200 * kMillisecond - spec.latency,
                      four = came.times[0] - 10 * kMillisecond - spec.latency;
    CHECK(static_cast<double>(four) > 4.0 * static_cast<double>(one));
    CHECK(four < 2 * kMillisecond);  // with gaps, acknowledgements and back-off between
    // However time is granted; without a mesh, or with fewer hops, it is out of range.
    CHECK(carry(spec, sent, cosim::kSecond, kMillisecond / 2).times == came.times);
    spec.settings.mesh_hops = 3;
    const Came fewer = carry(spec, sent, cosim::kSecond);
    CHECK(fewer.lines == Lines{"c near"});
    CHECK(fewer.report["mesh"]["no_way"] == 1);
    spec.settings.mesh = false;
    CHECK(carry(spec, sent, cosim::kSecond).lines == Lines{"c near"});
    std::remove(spec.routes_csv.c_str());
}

TEST_CASE("ways take the least time on the air, not the fewest hops", "[wifi][mesh]") {
    // 24 m with 36 Mbit/s at once, or twice 12 m with 54: once has less overhead. 60 m: 6 Mbit/s, or
    // twice 24.
    wifi::WifiSpec spec = row(3, 12);
    const std::vector<cosim::Message> sent{packet(0, 0, kFirst + 2, "x")};
    CHECK(carry(spec, sent, kMillisecond * 100).report["mesh"]["passed_on"]["b"] == 0);
    spec = row(3, 30);
    CHECK(carry(spec, sent, kMillisecond * 100).report["mesh"]["passed_on"]["b"] == 1);
}

TEST_CASE("a packet for all reaches each station once, over several hops", "[wifi][mesh]") {
    wifi::WifiSpec spec = row(6, 55);
    std::vector<cosim::Message> sent;
    for (int i = 0; i < 20; ++i)
        sent.push_back(packet(i * 200 * kMillisecond, 0, kEverybody, std::to_string(i)));
    const Came came = carry(spec, sent, 5 * cosim::kSecond);
    // Nobody acknowledges a broadcast: neighbours' neighbours may pass on at once, and some are lost.
    for (const char station : std::string("bcdef")) {
        int heard = 0;
        for (int i = 0; i < 20; ++i)
            heard += static_cast<int>(
                std::count(came.lines.begin(), came.lines.end(), fmt::format("{} {}", station, i)));
        INFO(station);
        CHECK(heard >= 18);
        CHECK(heard <= 20);
    }
    CHECK(std::count_if(came.lines.begin(), came.lines.end(),
                        [](const std::string& l) { return l[0] == 'a'; }) == 0);
    const Came again = carry(spec, sent, 5 * cosim::kSecond, kMillisecond);
    CHECK(again.times == came.times);
    spec.settings.mesh_hops = 2;
    for (const std::string& line : carry(spec, sent, 5 * cosim::kSecond).lines)
        CHECK((line[0] == 'b' || line[0] == 'c'));
}

TEST_CASE("ways change as stations move and walls come, at the next update", "[wifi][mesh]") {
    // a, b, c in a row; d beside b. b walks away at 1.2 s.
    wifi::WifiSpec spec = row(3, 40);
    spec.stations[1].pose = 3;
    spec.stations.push_back({.computer = {"d", "10.0.0.4"}, .at = {40, 20}});
    spec.routes_csv = "mesh_changes.csv";
    spec.settings.route_every = 0.5;
    std::vector<cosim::Message> sent;
    for (int i = 0; i < 30; ++i) {
        if (i == 12) sent.push_back({1200 * kMillisecond, 4, cosim::Signal{4, 500.0}});
        sent.push_back(packet((i * 100 + 10) * kMillisecond, 0, kFirst + 2, std::to_string(i)));
    }
    const Came came = carry(spec, sent, 4 * cosim::kSecond);
    const auto& mesh = came.report["mesh"];
    INFO(came.report.dump());
    // Those of 1.21, 1.31 and 1.41 s go to b, which is not there any more; from 1.5 s on they go over d.
    CHECK(came.lines.size() == 27);
    CHECK(mesh["passed_on"]["b"] == 12);
    CHECK(mesh["passed_on"]["d"] == 15);
    const std::string routes = text_in(spec.routes_csv);
    INFO(routes);
    CHECK(routes.find("1.500000,a,c,d,2\n") != std::string::npos);
    CHECK(routes.find("1.500000,a,b,,0\n") != std::string::npos);
    CHECK(mesh["route_changes"] > 4);
    // A wall that comes between a and d leaves no way.
    spec.first_shape = 100;
    spec.settings.thing_loss = 60;
    for (const auto& [k, value] : {std::pair(0, 1.0), {1, 10.0}, {2, 0.0}, {4, 0.1}, {5, 50.0}, {6, 1.0}})
        sent.push_back({2300 * kMillisecond, 4, cosim::Signal{static_cast<std::uint16_t>(100 + k), value}});
    std::stable_sort(sent.begin(), sent.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
    const Came walled = carry(spec, sent, 4 * cosim::kSecond);
    CHECK(walled.lines.back() == "c 22");
    CHECK(walled.report["mesh"]["no_way"] == 5);  // from 2.5 s on
    std::remove(spec.routes_csv.c_str());
}

TEST_CASE("a mesh has no access point", "[wifi][mesh]") {
    wifi::WifiSpec spec = row(2, 1);
    spec.access_point = {0, 0};
    CHECK_THROWS_WITH(wifi::WifiNode(spec), Catch::Contains("a mesh has no access point"));
}
