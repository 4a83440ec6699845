// The node between computers: who gets a packet, and when.

#include "tests/network/wire_kit.h"

#include "base/error.h"
#include "base/json.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace puckloop;
using namespace puckloop::tests;
using cosim::kMillisecond;

using Lines = std::vector<std::string>;

TEST_CASE("a packet reaches its computer after the latency, a broadcast all others", "[network]") {
    const std::vector<cosim::Message> sent{packet(0, 0, kFirst + 1, "one"),
                                           packet(kMillisecond, 1, kEverybody, "all"),
                                           packet(2 * kMillisecond, 2, kFirst + 8, "nobody")};
    for (const cosim::Time step : {10 * kMillisecond, kMillisecond / 4})
        CHECK(carried(three(kMillisecond), sent, 10 * kMillisecond, step) ==
              Lines{"1000 us b one", "2000 us a all", "2000 us c all"});
}

TEST_CASE("packets take the channel one behind the other at its rate", "[network]") {
    // 1250 octets at 1 Mbit/s: 10 ms.
    const std::vector<cosim::Message> sent{packet(0, 0, kFirst + 1, "one", 1250),
                                           packet(0, 2, kFirst + 1, "two", 1250),
                                           packet(50 * kMillisecond, 1, kFirst, "three", 125)};
    CHECK(carried(three(kMillisecond, 1e6), sent, 100 * kMillisecond, 5 * kMillisecond) ==
          Lines{"11000 us b one", "21000 us b two", "52000 us a three"});
}

TEST_CASE("an interface keeps so many packets and no more", "[network]") {
    network::NetworkSpec spec = three(kMillisecond, 1e6);
    spec.queue = 2;
    network::NetworkNode node(spec);
    std::vector<cosim::Message> inbox, outbox;
    for (int i = 0; i < 5; ++i)
        inbox.push_back(packet(i, 0, kFirst + 1, std::to_string(i), 1250));
    inbox.push_back(packet(5, 2, kFirst + 1, "c", 1250));
    node.advance(cosim::kSecond, inbox, outbox);
    CHECK(arrived(outbox) == Lines{"11000 us b 0", "21000 us b 1", "31000 us b 2", "41000 us b c"});
    const auto report = nlohmann::json::parse(node.finish());
    CHECK(report["stations"]["a"]["queue_full"] == 2);
    CHECK(report["stations"]["b"]["packets_received"] == 4);
}

TEST_CASE("the node promises nothing that it does not keep", "[network]") {
    network::NetworkNode node(three(kMillisecond, 1e6));
    CHECK(node.lookahead(0) == kMillisecond + 160 * cosim::kMicrosecond);
    std::vector<cosim::Message> outbox;
    node.advance(kMillisecond, std::vector{packet(0, 0, kFirst + 1, "x", 125)}, outbox);
    CHECK(outbox.empty());
    CHECK(node.earliest_output(1) == 2 * kMillisecond);
    CHECK(node.earliest_output(0) == cosim::kNever);
}

TEST_CASE("a station without an address is refused", "[network]") {
    network::NetworkSpec spec = three(kMillisecond);
    spec.stations[1].address = "10.0.0";
    CHECK_THROWS_AS(network::NetworkNode(spec), InputError);
}
