// Packets are read as they were written, and what was damaged on the way is not read at all.

#include "protocols/network/ip_packet.h"

#include "base/random.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::protocols;

namespace {

constexpr IpAddress kHere = 0x0a000001, kThere = 0x0a000002;

IpPacket packet_with(Octet protocol, std::vector<Octet> payload) {
    IpPacket packet;
    packet.from = kHere;
    packet.to = kThere;
    packet.protocol = protocol;
    packet.id = 77;
    packet.payload = std::move(payload);
    return packet;
}

}  // namespace

TEST_CASE("an address is four decimal numbers", "[ip]") {
    CHECK(address_of("10.0.0.1") == kHere);
    CHECK(address_of("255.255.255.255") == 0xffffffff);
    for (const char* bad : {"", "10", "10.0.0", "10.0.0.256", "10.0.0.1.2", "10.0.0.1 ", "a.b.c.d", "10..0.1",
                            "-1.0.0.1", "10.0.0.0001"})
        CHECK_FALSE(address_of(bad));
    CHECK(to_text(kThere) == "10.0.0.2");
}

TEST_CASE("UDP, TCP and ICMP come back as they went", "[ip]") {
    const auto octets = encode(packet_with(kUdp, encode_udp({5000, 6000, "hello"}, kHere, kThere)));
    const auto packet = decode_ip(octets);
    REQUIRE(packet);
    CHECK(packet->id == 77);
    const auto udp = decode_udp(*packet);
    REQUIRE(udp);
    CHECK(udp->from_port == 5000);
    CHECK(udp->data == "hello");
    CHECK(describe(*packet) == "UDP 10.0.0.1:5000 > 10.0.0.2:6000 5 octets");

    TcpSegment segment{1, 2, 0xfffffff0, 7, kSyn | kAck, 4000, 1460, "abc"};
    const auto tcp = decode_tcp(packet_with(kTcp, encode_tcp(segment, kHere, kThere)));
    REQUIRE(tcp);
    CHECK(tcp->sequence == 0xfffffff0);
    CHECK(tcp->most == 1460);
    CHECK(tcp->data == "abc");
    CHECK(tcp->length() == 4);

    const auto icmp = decode_icmp(packet_with(kIcmp, encode_icmp({kUnreachable, 3, 9, {1, 2, 3}})));
    REQUIRE(icmp);
    CHECK(icmp->data == std::vector<Octet>{1, 2, 3});
}

TEST_CASE("any single wrong bit is found", "[ip]") {
    const auto sound = encode(packet_with(kUdp, encode_udp({5000, 6000, "an odd number"}, kHere, kThere)));
    for (std::size_t bit = 0; bit < 8 * sound.size(); ++bit) {
        auto octets = sound;
        octets[bit / 8] = static_cast<Octet>(octets[bit / 8] ^ 1u << bit % 8);
        const auto packet = decode_ip(octets);
        INFO("bit " << bit);
        CHECK((!packet || !decode_udp(*packet)));
    }
}

TEST_CASE("what is cut short is no packet", "[ip]") {
    const auto sound =
        encode(packet_with(kTcp, encode_tcp({1, 2, 3, 4, kAck, 5, 6, "seven"}, kHere, kThere)));
    for (std::size_t size = 0; size < sound.size(); ++size)
        CHECK_FALSE(decode_ip(std::span(sound).first(size)));
}
