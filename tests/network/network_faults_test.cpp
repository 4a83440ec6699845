// What faults of the network do to packets.

#include "tests/network/wire_kit.h"

#include "base/error.h"
#include "base/json.h"
#include "cosim/faults/kinds/kind_table.h"
#include "cosim/faults/node_fault.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace puckloop;
using namespace puckloop::tests;
using cosim::FaultSpec;
using cosim::kMillisecond;

using Lines = std::vector<std::string>;

namespace {

FaultSpec fault_of(const std::string& kind) {
    FaultSpec fault;
    fault.node = "network";
    fault.kind = kind;
    fault.name = "it";
    return fault;
}

network::NetworkSpec with(FaultSpec fault) {
    network::NetworkSpec spec = three(kMillisecond);
    cosim::complete(fault, *cosim::find_kind(fault.kind, cosim::PlaceKind::Network));
    spec.faults = cosim::carried({{fault, 1, 0}});
    return spec;
}

/// Three packets from a to b, one from b to a and one from c to a, 1 ms apart.
Lines after(const FaultSpec& fault, double* fired = nullptr) {
    const std::vector<cosim::Message> sent{
        packet(0, 0, kFirst + 1, "one"), packet(kMillisecond, 0, kFirst + 1, "two"),
        packet(2 * kMillisecond, 0, kFirst + 1, "three"), packet(3 * kMillisecond, 1, kFirst, "back"),
        packet(4 * kMillisecond, 2, kFirst, "third")};
    const Lines lines = carried(with(fault), sent, 100 * kMillisecond, 100 * kMillisecond);
    CHECK(carried(with(fault), sent, 100 * kMillisecond, kMillisecond / 4) == lines);
    if (fired != nullptr) {
        network::NetworkNode node(with(fault));
        std::vector<cosim::Message> outbox;
        node.advance(cosim::kSecond, sent, outbox);
        *fired = nlohmann::json::parse(node.finish())["faults"][0]["fired"];
    }
    return lines;
}

const Lines kAll{"1000 us b one", "2000 us b two", "3000 us b three", "4000 us a back", "5000 us a third"};

Lines without(std::initializer_list<std::size_t> left_out) {
    Lines lines;
    for (std::size_t i = 0; i < kAll.size(); ++i)
        if (std::find(left_out.begin(), left_out.end(), i) == left_out.end()) lines.push_back(kAll[i]);
    return lines;
}

}  // namespace

TEST_CASE("loss takes what it is meant for", "[network]") {
    FaultSpec fault = fault_of("loss");
    double fired = 0;
    CHECK(after(fault, &fired).empty());
    CHECK(fired == 5);
    fault.from = "a";
    CHECK(after(fault) == without({0, 1, 2}));
    fault.skip = 1;
    fault.count = 1;
    CHECK(after(fault) == without({1}));
    fault = fault_of("loss");
    fault.set("to", "a");
    CHECK(after(fault) == without({3, 4}));
    fault = fault_of("loss");
    for (const char c : std::string("two"))
        fault.match.push_back(static_cast<std::uint8_t>(c));
    CHECK(after(fault, &fired) == without({1}));
    CHECK(fired == 1);
}

TEST_CASE("duplicate, delay, corrupt", "[network]") {
    FaultSpec fault = fault_of("duplicate");
    fault.count = 1;
    Lines lines = kAll;
    lines.insert(lines.begin() + 1, "1001 us b one");
    CHECK(after(fault) == lines);
    fault = fault_of("delay");
    fault.from = "b";
    fault.set("delay", 0.01);
    CHECK(after(fault) ==
          Lines{"1000 us b one", "2000 us b two", "3000 us b three", "5000 us a third", "14000 us a back"});
    fault = fault_of("corrupt");
    fault.count = 1;
    lines = kAll;
    lines[0] = "1000 us b ?";
    CHECK(after(fault) == lines);
}

TEST_CASE("a packet that is kept back comes behind the next one, or late", "[network]") {
    FaultSpec fault = fault_of("reorder");
    fault.from = "a";
    fault.count = 1;
    CHECK(after(fault) ==
          Lines{"2000 us b two", "2001 us b one", "3000 us b three", "4000 us a back", "5000 us a third"});
    fault.skip = 2;
    CHECK(after(fault) ==
          Lines{"1000 us b one", "2000 us b two", "4000 us a back", "5000 us a third", "13000 us b three"});
}

TEST_CASE("a partition holds for its time, between a group and the others", "[network]") {
    FaultSpec fault = fault_of("partition");
    double fired = 0;
    CHECK(after(fault, &fired).empty());
    CHECK(fired == 5);
    fault.set("group", "a+c");
    CHECK(after(fault) == without({0, 1, 2, 3}));
    fault.begin = kMillisecond;
    fault.end = 3 * kMillisecond;
    CHECK(after(fault) == without({1, 2}));
    fault.set("group", "a+x");
    CHECK_THROWS_AS(after(fault), InputError);
}

TEST_CASE("a cap of the rate makes packets longer", "[network]") {
    FaultSpec fault = fault_of("rate");
    fault.set("rate", 800'000.0);  // 100 octets: 1 ms
    CHECK(after(fault) ==
          Lines{"2000 us b one", "3000 us b two", "4000 us b three", "5000 us a back", "6000 us a third"});
    fault.from = "c";
    double fired = 0;
    CHECK(after(fault, &fired).back() == "6000 us a third");
    CHECK(fired == 1);
}

namespace {

protocols::TcpSegment segment(std::uint32_t sequence, const std::string& data, protocols::Octet flags,
                              std::uint32_t acknowledged = 0) {
    protocols::TcpSegment one;
    one.from_port = one.to_port = 7;
    one.sequence = sequence;
    one.data = data;
    one.flags = flags;
    one.acknowledged = acknowledged;
    return one;
}

cosim::Message tcp(cosim::Time time, std::size_t from, std::size_t to, protocols::TcpSegment one) {
    protocols::IpPacket packet;
    packet.from = kFirst + static_cast<protocols::IpAddress>(from);
    packet.to = kFirst + static_cast<protocols::IpAddress>(to);
    packet.protocol = protocols::kTcp;
    packet.payload = protocols::encode_tcp(one, packet.from, packet.to);
    return {time, static_cast<cosim::PortIndex>(from),
            cosim::Packet{time, 0, cosim::Octets(protocols::encode(packet))}};
}

/// "a S 100", "b RA 106", "b A 101 hello": to whom, flags, sequence number, data.
Lines segments_after(const FaultSpec& fault, const std::vector<cosim::Message>& sent) {
    network::NetworkNode node(with(fault));
    std::vector<cosim::Message> outbox;
    node.advance(cosim::kSecond, sent, outbox);
    std::stable_sort(outbox.begin(), outbox.end(),
                     [](const auto& x, const auto& y) { return x.time < y.time; });
    Lines lines;
    for (const cosim::Message& message : outbox) {
        const auto packet = protocols::decode_ip(std::get<cosim::Packet>(message.payload).octets.view());
        REQUIRE(packet);
        const auto read = protocols::decode_tcp(*packet);
        REQUIRE(read);
        std::string flags;
        for (const auto& [flag, letter] :
             {std::pair{protocols::kSyn, 'S'}, {protocols::kRst, 'R'}, {protocols::kAck, 'A'}})
            if ((read->flags & flag) != 0) flags += letter;
        lines.push_back(fmt::format("{} {} {}{}{}", "abc"[message.port], flags, read -> sequence,
                                    read -> data.empty() ? "" : " ", read->data));
    }
    return lines;
}

using protocols::kAck;
using protocols::kSyn;

/// A connection from a to b that sends twice five octets, with an acknowledgement between them.
std::vector<cosim::Message> talk(cosim::Time begin = 0) {
    const auto at = [&](int ms) { return begin + ms * kMillisecond; };
    return {tcp(at(0), 0, 1, segment(99, "", kSyn)),
            tcp(at(2), 1, 0, segment(499, "", static_cast<protocols::Octet>(kSyn | kAck), 100)),
            tcp(at(4), 0, 1, segment(100, "hello", kAck, 500)),
            tcp(at(6), 1, 0, segment(500, "", kAck, 105)),
            tcp(at(8), 0, 1, segment(105, "world", kAck, 500)),
            tcp(at(10), 1, 0, segment(500, "back", kAck, 107))};
}

}  // namespace

TEST_CASE("a connection is reset at an octet", "[network]") {
    FaultSpec fault = fault_of("connection_reset");
    fault.set("byte", 7.0);
    // What is before the octet arrives, then both ends are reset, and whoever goes on is again.
    const Lines until{"b S 99", "a SA 499", "b A 100 hello", "a A 500"};
    Lines lines = until;
    lines.insert(lines.end(), {"b A 105 wo", "a R 500", "b RA 107", "b R 107"});
    CHECK(segments_after(fault, talk()) == lines);
    // At the first octet, and at one that never comes.
    fault.set("byte", 0.0);
    CHECK(segments_after(fault, talk()) ==
          Lines{"b S 99", "a SA 499", "a R 500", "b RA 100", "b R 105", "a R 500", "b R 107"});
    fault.set("byte", 10.0);
    lines = until;
    lines.insert(lines.end(), {"b A 105 world", "a A 500 back"});
    CHECK(segments_after(fault, talk()) == lines);
    // In the other direction.
    fault.set("byte", 1.0);
    fault.from = "b";
    lines = until;
    lines.insert(lines.end(), {"b A 105 world", "a A 500 b", "a RA 501", "b R 107"});
    CHECK(segments_after(fault, talk()) == lines);
}

TEST_CASE("connections are candidates of a reset, one by one", "[network]") {
    FaultSpec fault = fault_of("connection_reset");
    fault.count = 1;
    std::vector<cosim::Message> sent = talk();
    for (const cosim::Message& message : talk(20 * kMillisecond))
        sent.push_back(message);
    // The ports are the same: the second connection's SYN ends the first one.
    const Lines lines = segments_after(fault, sent);
    REQUIRE(lines.size() == 13);
    CHECK(lines[2] == "a R 500");
    CHECK(lines[3] == "b RA 100");
    CHECK(lines[9] == "b A 100 hello");
    fault.skip = 1;
    CHECK(segments_after(fault, talk())[2] == "b A 100 hello");
}

TEST_CASE("an address that another computer has too", "[network]") {
    FaultSpec fault = fault_of("address_clash");
    fault.set("share", 1.0);
    double fired = 0;
    CHECK(after(fault, &fired).empty());
    CHECK(fired == 5);
    fault.set("to", "b");
    CHECK(after(fault) == without({0, 1, 2}));
    // TCP is answered, with a reset of what was acknowledged.
    CHECK(segments_after(fault, {tcp(0, 0, 1, segment(99, "", kSyn))}) == Lines{"a RA 0"});
    fault.set("answers", "nothing");
    CHECK(segments_after(fault, {tcp(0, 0, 1, segment(99, "", kSyn))}).empty());
    fault.set("share", 0.0);
    CHECK(after(fault) == kAll);
    // To all it goes wherever it went.
    fault.set("share", 1.0);
    network::NetworkNode node(with(fault));
    std::vector<cosim::Message> outbox;
    node.advance(cosim::kSecond, std::vector{packet(0, 0, kEverybody, "all")}, outbox);
    CHECK(outbox.size() == 2);
}

TEST_CASE("whoever believes the wrong computer does so for a while", "[network]") {
    FaultSpec fault = fault_of("address_clash");
    fault.set("cache", 0.01);
    network::NetworkNode node(with(fault));
    std::vector<cosim::Message> sent, outbox;
    constexpr int kSent = 2000, kInCache = 10;
    for (int i = 0; i < kSent; ++i)
        sent.push_back(packet(i * kMillisecond, 0, kFirst + 1, std::to_string(i)));
    node.advance(3 * cosim::kSecond, sent, outbox);
    // Ten at a time have one fate; half of these times it is the wrong one.
    std::vector<bool> came(kSent);
    for (const cosim::Message& message : outbox)
        came[static_cast<std::size_t>(message.time / kMillisecond - 1)] = true;
    int right = 0;
    for (int first = 0; first < kSent; first += kInCache) {
        right += came[static_cast<std::size_t>(first)] ? 1 : 0;
        for (int i = first; i < first + kInCache; ++i)
            CHECK(came[static_cast<std::size_t>(i)] == came[static_cast<std::size_t>(first)]);
    }
    CHECK(right > 75);
    CHECK(right < 125);
}

TEST_CASE("faults of connections take any octets for packets (seeded)", "[network]") {
    RandomStream random(42, "segments");
    for (const char* kind : {"connection_reset", "address_clash"}) {
        FaultSpec fault = fault_of(kind);
        network::NetworkNode node(with(fault));
        std::vector<cosim::Message> sent, outbox;
        for (int i = 0; i < 4000; ++i) {
            protocols::TcpSegment one = segment(static_cast<std::uint32_t>(random.next()), "", 0,
                                                static_cast<std::uint32_t>(random.next()));
            one.flags = static_cast<protocols::Octet>(random.below(64));
            one.data.resize(random.below(3) == 0 ? random.below(1400) : 0);
            one.from_port = static_cast<std::uint16_t>(random.below(4));
            one.to_port = static_cast<std::uint16_t>(random.below(4));
            const std::size_t from = random.below(3), to = random.below(3);
            cosim::Message message = tcp(i * kMillisecond / 10, from, to, one);
            if (random.below(4) == 0) {  // damaged beyond its header
                auto& octets = std::get<cosim::Packet>(message.payload).octets;
                std::vector<std::uint8_t> bytes(octets.view().begin(), octets.view().end());
                bytes.resize(protocols::kIpHeader + random.below(bytes.size() - protocols::kIpHeader + 1));
                octets = cosim::Octets(bytes);
            }
            sent.push_back(message);
        }
        node.advance(2 * cosim::kSecond, sent, outbox);
        // Each becomes three at most: what is kept of it, and a reset to either end.
        CHECK(outbox.size() <= 3 * sent.size());
        CHECK(nlohmann::json::parse(node.finish())["faults"][0]["fired"] > 10);
    }
}
