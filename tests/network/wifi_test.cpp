// The radio of a network: throughput against Bianchi's model, hidden stations, rates, ranges and retries, and
// that nothing depends on how time is granted.

#include "base/error.h"
#include "cosim/faults/node_fault.h"
#include "tests/kit/files.h"
#include "tests/network/wifi_kit.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>

using namespace puckloop;
using namespace puckloop::tests;
using cosim::kMillisecond;
using wifi::WifiSettings;

namespace {

/// What the model needs of a standard, in microseconds, by the standard's figures and not by the program's.
struct Figures {
    double slot, sifs, difs, frame, ack;
    double first_window;  ///< W: slots to draw from
    int doublings;        ///< m
};

/// 1500 octets with 36 of headers and check at 11 Mbit/s, acknowledged with 14 at 2 Mbit/s; long preambles.
constexpr Figures kB{20, 10, 50, 192 + std::ceil(8 * 1536 / 11.0), 192 + 8 * 14 / 2.0, 32, 5};
/// The same at 54 and 24 Mbit/s, 216 and 96 bits in a symbol of 4 us; 6 us behind each.
constexpr Figures kG{
    9, 10, 28, 26 + 4 * std::ceil((22 + 8 * 1536) / 216.0), 26 + 4 * std::ceil((22 + 8 * 14) / 96.0), 16, 6};

/// G. Bianchi, Performance analysis of the IEEE 802.11 distributed coordination function, 2000: equations 7,
/// 9 and 13, basic access. The fixed point by bisection: p grows with tau, and tau falls with p.
double bianchi(int stations, const Figures& of, double payload_bits) {
    const auto tau_of = [&](double p) {
        const double w = of.first_window, m = of.doublings;
        return 2 * (1 - 2 * p) / ((1 - 2 * p) * (w + 1) + p * w * (1 - std::pow(2 * p, m)));
    };
    double low = 0, high = 0.4999;
    for (int i = 0; i < 100; ++i) {
        const double p = (low + high) / 2;
        (1 - std::pow(1 - tau_of(p), stations - 1) > p ? low : high) = p;
    }
    const double tau = tau_of((low + high) / 2), any = 1 - std::pow(1 - tau, stations);
    const double success = stations * tau * std::pow(1 - tau, stations - 1);
    const double good = of.frame + of.sifs + of.ack + of.difs, bad = of.frame + of.difs;
    const double mean = (1 - any) * of.slot + success * good + (any - success) * bad;
    return success * payload_bits / (mean * 1e-6);
}

std::size_t count_of(const std::string& text, const std::string& what) {
    std::size_t found = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1))
        ++found;
    return found;
}

using Lines = std::vector<std::string>;

/// Two stations at (-d, 0) and (d, 0) without an access point, with one of c at (far, 0).
wifi::WifiSpec ad_hoc(double d, double far) {
    wifi::WifiSpec spec;
    spec.settings.shadowing = 0;
    spec.latency = kMillisecond;
    spec.stations = {
        {{"a", "10.0.0.1"}, {-d, 0}}, {{"b", "10.0.0.2"}, {d, 0}}, {{"c", "10.0.0.3"}, {far, 0}}};
    return spec;
}

std::vector<cosim::Message> carry(const wifi::WifiSpec& spec, const std::vector<cosim::Message>& sent,
                                  cosim::Time end, cosim::Time step, std::string* report = nullptr) {
    wifi::WifiNode node(spec);
    std::vector<cosim::Message> outbox;
    std::size_t next = 0;
    for (cosim::Time until = step; until <= end; until += step) {
        std::vector<cosim::Message> inbox;
        while (next < sent.size() && sent[next].time < until)
            inbox.push_back(sent[next++]);
        node.advance(until, inbox, outbox);
    }
    if (report != nullptr) *report = node.finish();
    std::stable_sort(outbox.begin(), outbox.end(),
                     [](const auto& a, const auto& b) { return a.time < b.time; });
    return outbox;
}

}  // namespace

TEST_CASE("saturation throughput is within 10 % of Bianchi's model", "[wifi]") {
    for (const bool g : {false, true})
        for (const int stations : {1, 2, 5, 10}) {
            wifi::WifiSpec spec = ring(static_cast<std::size_t>(stations));
            if (g) {
                spec.settings.standard = "g";
                spec.settings.rate = 54e6;
            }
            const double expected = bianchi(stations, g ? kG : kB, kFloodPayload);
            const Flooded result = flood(spec, 4.0);
            INFO(stations << " stations of 802.11" << (g ? "g" : "b") << ": " << result.bits / 1e6
                          << " Mbit/s, by the model " << expected / 1e6);
            if (std::getenv("PUCKLOOP_SHOW_FIGURES") != nullptr)
                fmt::print("802.11{} {:2}: {:.2f} Mbit/s, model {:.2f}, {:+.1f} %\n", g ? 'g' : 'b', stations,
                           result.bits / 1e6, expected / 1e6, 100 * (result.bits / expected - 1));
            CHECK(result.bits == Approx(expected).epsilon(0.10));
            // In the long run everybody gets the same.
            for (const double one : result.of_each)
                CHECK(one == Approx(result.bits / stations).epsilon(0.25));
        }
}

TEST_CASE("stations that do not hear each other lose more than those that do", "[wifi]") {
    // 42 m to the access point: -73.9 dBm, which 11 Mbit/s reads; 84 m to each other: -82.9 dBm, which is
    // free.
    const wifi::WifiSpec hidden = ring(2, 42.0);
    wifi::WifiSpec seen = hidden;
    seen.settings.power += 3;
    const Flooded open = flood(seen, 3.0), blind = flood(hidden, 3.0);
    INFO(open.bits / 1e6 << " Mbit/s seen, " << blind.bits / 1e6 << " hidden");
    if (std::getenv("PUCKLOOP_SHOW_FIGURES") != nullptr)
        fmt::print("seen {:.2f} Mbit/s, hidden {:.2f}\n", open.bits / 1e6, blind.bits / 1e6);
    CHECK(blind.bits < 0.7 * open.bits);
    const auto& lost = blind.report["access_point"];
    CHECK(lost["collisions"] > 2 * open.report["access_point"]["collisions"].get<int>());
    CHECK(open.bits == Approx(bianchi(2, kB, kFloodPayload)).epsilon(0.10));
}

TEST_CASE("the same seed gives the same frames however time is granted, another seed others", "[wifi]") {
    const auto times = [](const Flooded& result) {
        std::vector<cosim::Message> sorted = result.outbox;
        std::stable_sort(sorted.begin(), sorted.end(),
                         [](const auto& a, const auto& b) { return a.time < b.time; });
        std::vector<cosim::Time> list;
        for (const auto& message : sorted)
            list.push_back(message.time);
        return list;
    };
    wifi::WifiSpec spec = ring(3);
    const auto first = times(flood(spec, 0.5));
    CHECK(first.size() > 100);
    CHECK(times(flood(spec, 0.5)) == first);
    CHECK(times(flood(spec, 0.5, 100 * cosim::kMicrosecond)) == first);
    CHECK(times(flood(spec, 0.5, 500 * kMillisecond)) == first);
    spec.seed = 2;
    CHECK(times(flood(spec, 0.5)) != first);
}

TEST_CASE("a frame on a free channel goes at once and takes preamble, data and latency", "[wifi]") {
    wifi::WifiSpec spec = ad_hoc(1, 2);
    spec.settings.rate = 54e6;
    // 100 + 36 octets at 54 Mbit/s: 20 + 4 * 6 + 6 us; to all at 6 Mbit/s: 20 + 4 * 47 + 6 us.
    const std::vector<cosim::Message> sent{packet(50 * kMillisecond, 0, kFirst + 1, "one"),
                                           packet(80 * kMillisecond, 1, kEverybody, "all")};
    for (const cosim::Time step : {100 * kMillisecond, kMillisecond / 8})
        CHECK(arrived(carry(spec, sent, 100 * kMillisecond, step)) ==
              Lines{"51050 us b one", "81214 us a all", "81214 us c all"});
    spec.settings.standard = "b";
    spec.settings.rate = 11e6;
    spec.settings.preamble = "short";  // 96 + ceil(1088 / 11) us, 96 + 1088 us
    CHECK(arrived(carry(spec, sent, 100 * kMillisecond, kMillisecond)) ==
          Lines{"51195 us b one", "82184 us a all", "82184 us c all"});
}

TEST_CASE("who is out of range hears nothing, and the sender gives up after its attempts", "[wifi]") {
    wifi::WifiSpec spec = ad_hoc(1, 500);
    std::string report;
    const std::vector<cosim::Message> sent{packet(0, 0, kFirst + 2, "far"), packet(0, 0, kFirst + 1, "near"),
                                           packet(kMillisecond, 1, kEverybody, "all")};
    CHECK(arrived(carry(spec, sent, cosim::kSecond, 10 * kMillisecond, &report)).size() == 2);
    const auto stations = nlohmann::json::parse(report)["stations"];
    CHECK(stations["a"]["radio"]["dropped"] == 1);
    CHECK(stations["a"]["radio"]["again"] == 6);
    CHECK(stations["c"]["radio"]["weak"] == 8);
    CHECK(stations["b"]["packets_received"] == 1);
    // It comes nearer: a position of the world's.
    spec.stations[2].pose = 6;
    std::vector<cosim::Message> moved{{kMillisecond / 2, 3, cosim::Signal{6, 3.0}}};
    moved.push_back(packet(kMillisecond, 0, kFirst + 2, "far"));
    CHECK(arrived(carry(spec, moved, cosim::kSecond, 10 * kMillisecond)).size() == 1);
}

TEST_CASE("the access point passes on by radio and by wire, to one and to all", "[wifi]") {
    wifi::WifiSpec spec = ring(2);
    spec.latency = kMillisecond;
    const auto names = [&](const std::vector<cosim::Message>& sent) {
        Lines lines;
        for (const cosim::Message& message : carry(spec, sent, cosim::kSecond, kMillisecond))
            lines.push_back(spec.stations[message.port].computer.name);
        std::sort(lines.begin(), lines.end());
        return lines;
    };
    CHECK(names({packet(0, 0, kFirst + 1, "x")}) == Lines{"s1"});
    CHECK(names({packet(0, 0, kFirst + 253, "x")}) == Lines{"sink"});
    CHECK(names({packet(0, 0, kEverybody, "x")}) == Lines{"s1", "sink"});
    cosim::Message by_wire = packet(0, 253, kFirst, "x");
    by_wire.port = 2;
    CHECK(names({by_wire}) == Lines{"s0"});
    by_wire = packet(0, 253, kEverybody, "x");
    by_wire.port = 2;
    CHECK(names({by_wire}) == Lines{"s0", "s1"});
}

TEST_CASE("the rate follows the power where none is given", "[wifi]") {
    const std::string file = "wifi_rates.csv";
    for (const auto& [distance, rate] :
         {std::pair(2.0, ",54,"), std::pair(30.0, ",24,"), std::pair(60.0, ",6,")}) {
        wifi::WifiSpec spec = ad_hoc(distance / 2, 1000);
        spec.csv = file;
        carry(spec, {packet(0, 0, kFirst + 1, "x")}, 100 * kMillisecond, kMillisecond);
        const std::string text = text_of(file);
        INFO(distance << " m\n" << text);
        CHECK(count_of(text, rate) > 0);
        CHECK(count_of(text, ",data,") == 1);
        CHECK(count_of(text, ",ack,") == 1);
        CHECK(count_of(text, ",read\n") == 2);
    }
    std::remove(file.c_str());
}

TEST_CASE("shadows are drawn for each pair and stay", "[wifi]") {
    const WifiSettings settings;
    const std::vector<wifi::Position> places{{0, 0}, {10, 0}, {0, 10}};
    const wifi::Medium one(settings, {"a", "b", "c"}, places, 1),
        again(settings, {"b", "a"}, {{10, 0}, {0, 0}}, 1), other(settings, {"a", "b", "c"}, places, 2);
    CHECK(one.received_dbm(0, 1) == one.received_dbm(1, 0));
    CHECK(one.received_dbm(0, 1) == Approx(again.received_dbm(0, 1)));  // whoever else is there
    CHECK(one.received_dbm(0, 1) != Approx(one.received_dbm(0, 2)));
    CHECK(one.received_dbm(0, 1) != Approx(other.received_dbm(0, 1)));
    double sum = 0, squares = 0;
    constexpr int kPairs = 400;
    for (int i = 0; i < kPairs; ++i) {
        const wifi::Medium drawn(settings, {"a", fmt::format("b{}", i)}, {{0, 0}, {10, 0}}, 1);
        const double shadow = drawn.received_dbm(0, 1) - (15 - 40.2 - 30);
        sum += shadow;
        squares += shadow * shadow;
    }
    CHECK(sum / kPairs == Approx(0).margin(1.2));
    CHECK(std::sqrt(squares / kPairs) == Approx(7).epsilon(0.1));
}

TEST_CASE("two that get something to send at the same instant collide, and all send again", "[wifi]") {
    wifi::WifiSpec spec = ring(4);
    std::string report;
    std::vector<cosim::Message> sent;
    for (std::size_t s = 0; s < 4; ++s)
        sent.push_back(packet(5 * kMillisecond, s, kFirst + 253, "x"));
    CHECK(carry(spec, sent, cosim::kSecond, kMillisecond, &report).size() == 4);
    const auto result = nlohmann::json::parse(report);
    CHECK(result["access_point"]["collisions"] >= 4);
    // Beside each other nobody reads a frame; much nearer to the access point one does.
    spec.stations[0].at = {0.5, 0};
    CHECK(carry(spec, sent, cosim::kSecond, kMillisecond, &report).size() == 4);
    CHECK(nlohmann::json::parse(report)["stations"]["s0"]["radio"]["again"] == 0);
}

TEST_CASE("what the node states of its future holds", "[wifi]") {
    wifi::WifiSpec spec = ring(3);
    spec.stations.pop_back();
    wifi::WifiNode node(spec);
    const cosim::Time shortest = spec.latency + (192 + 41) * cosim::kMicrosecond;  // 56 octets at 11 Mbit/s
    CHECK(node.lookahead(0) == shortest);
    CHECK(node.earliest_output(0) == cosim::kNever);
    CHECK(node.earliest_output(3) == cosim::kNever);
    // In small steps: no packet comes before what was stated.
    RandomStream random(7, "grants");
    std::vector<cosim::Message> outbox;
    std::size_t handed = 0;
    for (cosim::Time now = 0; now < 500 * kMillisecond;) {
        std::vector<cosim::Message> inbox;
        cosim::Time at = cosim::kNever;
        if (random.below(3) == 0) {
            at = now;
            inbox.push_back(
                packet(now, random.below(3), random.below(2) != 0 ? kEverybody : kFirst, "x", 400));
        }
        std::vector<cosim::Time> bound;
        for (cosim::PortIndex p = 0; p < 3; ++p)
            bound.push_back(std::min(node.earliest_output(p), cosim::later(at, node.lookahead(p))));
        now += 1 + static_cast<cosim::Time>(random.below(300 * cosim::kMicrosecond));
        node.advance(now, inbox, outbox);
        for (; handed < outbox.size(); ++handed)
            REQUIRE(outbox[handed].time >= bound[outbox[handed].port]);
    }
    CHECK(outbox.size() > 100);
}

TEST_CASE("settings that cannot be are refused", "[wifi]") {
    const auto problem = [](auto&& change) {
        WifiSettings settings;
        change(settings);
        const auto found = wifi::problem_of(settings);
        if (found) CHECK_THROWS_AS(wifi::Phy(settings), InputError);
        return found ? found->key : "";
    };
    CHECK(problem([](WifiSettings&) {}).empty());
    CHECK(problem([](WifiSettings& s) { s.standard = "n"; }) == "standard");
    CHECK(problem([](WifiSettings& s) { s.preamble = "short"; }) == "preamble");
    CHECK(problem([](WifiSettings& s) { s.rate = 11e6; }) == "rate");
    CHECK(problem([](WifiSettings& s) { s.broadcast_rate = 7e6; }) == "broadcast_rate");
    CHECK(problem([](WifiSettings& s) { s.longest_window = 7; }) == "longest_window");
    wifi::WifiSpec spec = ring(1);
    spec.access_point.reset();
    CHECK_THROWS_WITH(wifi::WifiNode(spec), Catch::Contains("sink is wired to no access point"));
}

TEST_CASE("a robot's body in the way costs its loss, and no other one does", "[wifi]") {
    WifiSettings settings;
    settings.shadowing = 0;
    settings.body_loss = 6;
    wifi::Medium medium(settings, {"a", "b", "c", "d"}, {{-1, 0}, {1, 0}, {0, 0.03}, {0, 3}}, 1);
    settings.body_loss = 0;
    const wifi::Medium clear(settings, {"a", "b", "c", "d"}, {{-1, 0}, {1, 0}, {0, 0.03}, {0, 3}}, 1);
    medium.embody(2);
    CHECK(medium.received_dbm(0, 1) == Approx(clear.received_dbm(0, 1) - 6));
    CHECK(medium.received_dbm(1, 0) == medium.received_dbm(0, 1));
    CHECK(medium.received_dbm(0, 2) == clear.received_dbm(0, 2));  // its own
    CHECK(medium.received_dbm(0, 3) == clear.received_dbm(0, 3));
    for (const wifi::Position& aside : {wifi::Position{0, 0.04}, {1.05, 0}, {-1.2, 0}}) {
        medium.move(2, aside);
        CHECK(medium.received_dbm(0, 1) == clear.received_dbm(0, 1));
    }
    medium.move(2, {0.5, -0.03});
    medium.embody(3);
    medium.move(3, {-0.5, 0.01});
    CHECK(medium.received_dbm(0, 1) == Approx(clear.received_dbm(0, 1) - 12));
}

TEST_CASE("bursts of interference take their share of the channel, and spoil what they hit", "[wifi]") {
    wifi::WifiSpec spec = ring(2);
    const double clean = flood(spec, 2.0).bits;
    spec.settings.bursts = 100;
    spec.settings.burst_time = 0.002;
    spec.settings.burst_power = -50;
    const Flooded disturbed = flood(spec, 2.0);
    // A gap of 10 ms in the mean, then 2 ms; the frame that a burst hits (1.3 ms) is lost beside.
    const double share = disturbed.report["interference"]["air_s"].get<double>() / 2.0;
    CHECK(disturbed.report["interference"]["bursts"].get<int>() == Approx(2.0 / 0.012).epsilon(0.25));
    CHECK(share == Approx(1.0 / 6).epsilon(0.35));
    CHECK(disturbed.bits < (1 - share) * clean);
    CHECK(disturbed.bits > 0.6 * (1 - share) * clean);
    // However time is granted.
    CHECK(flood(spec, 0.5, kMillisecond).bits == flood(spec, 0.5).bits);
    // Too weak to be sensed, and 30 dB below every frame.
    spec.settings.burst_power = -110;
    const Flooded weak = flood(spec, 2.0);
    CHECK(weak.bits == Approx(clean).epsilon(0.02));
    CHECK(weak.report["interference"]["bursts"] > 100);
    CHECK_FALSE(flood(ring(1), 0.1).report.contains("interference"));
}

TEST_CASE("an access point that is away reads nothing and loses what it kept", "[wifi]") {
    wifi::WifiSpec spec = ring(2);
    spec.latency = kMillisecond;
    cosim::FaultSpec fault;
    fault.node = fault.name = "network";
    fault.kind = "access_point_away";
    fault.begin = 20 * kMillisecond;
    fault.end = cosim::kSecond;
    spec.faults = cosim::carried({{fault, 1, 0}});
    std::vector<cosim::Message> sent;
    for (int i = 0; i < 10; ++i)
        sent.push_back(
            packet(i == 9 ? 1200 * kMillisecond : 10 * i * kMillisecond, 0, kFirst + 1, std::to_string(i)));
    std::string report;
    const auto texts = [&](cosim::Time step) {
        Lines lines;
        for (const cosim::Message& message : carry(spec, sent, 2 * cosim::kSecond, step, &report)) {
            const auto read = protocols::decode_ip(std::get<cosim::Packet>(message.payload).octets.view());
            lines.emplace_back(protocols::decode_udp(*read)->data.c_str());
        }
        return lines;
    };
    // Those of 20 ms and later are tried seven times each, and given up.
    const Lines came = texts(kMillisecond);
    CHECK(texts(100 * kMillisecond) == came);
    const auto read = nlohmann::json::parse(report);
    INFO(report << fmt::format("{}", fmt::join(came, " ")));
    CHECK(came == Lines{"0", "1", "9"});
    CHECK(read["access_point"]["away"] == 7 * 7);
    CHECK(read["stations"]["s0"]["radio"]["dropped"] == 7);
    CHECK(read["faults"][0]["fired"] == read["access_point"]["away"]);
    CHECK(read["faults"][0]["firings"][0][2] == "a frame of s0 is not read");
    // By wire, and what waits in it: ten packets of 1500 octets at 11 Mbit/s take 15 ms and more.
    sent.clear();
    for (int i = 0; i < 10; ++i) {
        sent.push_back(packet(16 * kMillisecond, 253, kFirst, std::to_string(i), 1500));
        sent.back().port = 2;
    }
    sent.push_back(packet(30 * kMillisecond, 253, kFirst, "late", 1500));
    sent.back().port = 2;
    const Lines before = texts(kMillisecond);
    CHECK(before.size() > 0);
    CHECK(before.size() < 5);
    const auto lost = nlohmann::json::parse(report)["faults"][0];
    // The frame that was on the air then is read, and its acknowledgement is not.
    CHECK(lost["fired"] == 11 - before.size() + 1);
    CHECK(lost["firings"].back()[2] == "a packet of sink in the access point");
    spec.access_point.reset();
    spec.stations.pop_back();
    CHECK_THROWS_WITH(wifi::WifiNode(spec), Catch::Contains("no access point that could be away"));
}
