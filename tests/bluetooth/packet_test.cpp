// The packet format: every packet comes back, every damaged one is known as such, and random octets neither
// crash the reader nor keep it from the next packet.

#include "base/random.h"
#include "protocols/radio/lmx9820_packet.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::protocols;

namespace {

LmxPacket random_packet(RandomStream& random, std::size_t most = kMostLmxData) {
    constexpr std::array<std::uint8_t, 4> kTypes{kLmxRequest, kLmxConfirm, kLmxIndication, kLmxResponse};
    LmxPacket packet;
    packet.type = kTypes[random.below(kTypes.size())];
    packet.opcode = static_cast<std::uint8_t>(random.below(256));
    packet.data.resize(random.below(most + 1));
    for (std::uint8_t& octet : packet.data)
        octet = static_cast<std::uint8_t>(random.below(256));
    return packet;
}

}  // namespace

TEST_CASE("the packets of the e-puck library are read and written", "[bluetooth]") {
    // As its driver sends them: reset, read name, read PIN, inquiry of 5 x 1.28 s for ten devices.
    const std::vector<std::pair<LmxPacket, LmxBytes>> known{
        {{kLmxRequest, 0x26, {}}, {0x02, 0x52, 0x26, 0x00, 0x00, 0x78, 0x03}},
        {{kLmxRequest, 0x03, {}}, {0x02, 0x52, 0x03, 0x00, 0x00, 0x55, 0x03}},
        {{kLmxRequest, 0x16, {}}, {0x02, 0x52, 0x16, 0x00, 0x00, 0x68, 0x03}},
        {{kLmxRequest, 0x00, {5, 10, 0}}, {0x02, 0x52, 0x00, 0x03, 0x00, 0x55, 0x05, 0x0A, 0x00, 0x03}},
        {{kLmxRequest, 0x11, {1}}, {0x02, 0x52, 0x11, 0x01, 0x00, 0x64, 0x01, 0x03}},
    };
    for (const auto& [packet, octets] : known) {
        CHECK(encode_lmx(packet) == octets);
        LmxReader reader;
        std::optional<LmxReading> reading;
        for (const std::uint8_t octet : octets) {
            REQUIRE(!reading);
            reading = reader.take(octet);
        }
        REQUIRE(reading);
        CHECK(reading->ok());
        CHECK(reading->packet == packet);
    }
    CHECK(to_text(known[3].first) == "REQ GAP_INQUIRY 5 10 0");
    CHECK(to_text(LmxPacket{kLmxIndication, 0x01, {1, 0, 0x2c, 0x17, 0, 8, 0, 0, 0}}) ==
          "IND GAP_DEVICE_FOUND 08:00:17:2C:00:01 class=000000");
    CHECK(to_text(LmxPacket{kLmxConfirm, 0x0D, {0x1f, 1}}) == "CFM SPP_RELEASE_LINK NO_CONNECTION port=1");
    CHECK(to_text(LmxPacket{kLmxConfirm, 0x03, {0, 3, 'a', '"', 0}}) ==
          "CFM GAP_READ_LOCAL_NAME OK \"a\\x22\\x00\"");
}

TEST_CASE("packets come back through noise, and damaged ones do not pass", "[bluetooth]") {
    RandomStream random(20, "packets");
    LmxReader reader;
    std::size_t damaged = 0, refused = 0;
    for (int round = 0; round < 3000; ++round) {
        const LmxPacket packet = random_packet(random, round % 10 == 0 ? kMostLmxData : 12);
        LmxBytes octets = encode_lmx(packet);
        // One bit of header, check or end octet.
        if (round % 2 == 1) {
            const std::size_t header = random.below(7);
            const std::size_t at = header < 6 ? header : octets.size() - 1;
            octets[at] ^= static_cast<std::uint8_t>(1u << random.below(8));
            ++damaged;
            reader.clear();
            bool same = false;
            for (const std::uint8_t octet : octets)
                if (const auto reading = reader.take(octet))
                    same = same || (reading->ok() && reading->packet == packet);
            refused += same ? 0 : 1;
            reader.clear();
            continue;
        }
        for (std::uint64_t noise = random.below(5); noise > 0; --noise)
            reader.take(static_cast<std::uint8_t>(3 + random.below(253)));
        std::vector<LmxPacket> got;
        for (const std::uint8_t octet : octets)
            if (const auto reading = reader.take(octet); reading && reading->ok())
                got.push_back(reading->packet);
        CHECK(got == std::vector<LmxPacket>{packet});
    }
    CHECK(refused == damaged);
}

TEST_CASE("a fuzzed reader finds the packet behind any octets", "[bluetooth]") {
    RandomStream random(21, "fuzz");
    LmxReader reader;
    for (int round = 0; round < 20'000; ++round) {
        const std::uint64_t kind = random.below(4);
        LmxBytes octets = kind == 0 ? LmxBytes(random.below(20)) : encode_lmx(random_packet(random, 9));
        for (std::uint64_t i = 0; kind < 3 && i < 3 && !octets.empty(); ++i)
            octets[random.below(octets.size())] = static_cast<std::uint8_t>(random.below(256));
        for (const std::uint8_t octet : octets)
            if (const auto reading = reader.take(octet)) {
                CHECK(reading->packet.data.size() <= kMostLmxData);
                CHECK(!to_text(reading->packet).empty());
            }
    }
    // However it stands, so many octets end what it waits for.
    for (std::size_t i = 0; i < kLmxFrame + kMostLmxData; ++i)
        reader.take(0xFF);
    CHECK(reader.idle());
    // Every opcode with every length of data has a text.
    for (int opcode = 0; opcode < 256; ++opcode)
        for (std::size_t size = 0; size < 14; ++size)
            for (const std::uint8_t type : {kLmxRequest, kLmxConfirm, kLmxIndication, kLmxResponse})
                CHECK(!to_text(LmxPacket{type, static_cast<std::uint8_t>(opcode),
                                         LmxBytes(size, static_cast<std::uint8_t>(7 * size))})
                           .empty());
}
