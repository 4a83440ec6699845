// Captured frames of 802.11, octet by octet.

#include "protocols/network/ieee80211.h"

#include <catch2/catch.hpp>

#include <string_view>

using namespace puckloop::protocols;
using Octets = std::vector<std::uint8_t>;

namespace {

std::uint32_t check_of(std::string_view text) {
    return frame_check(Octets(text.begin(), text.end()));
}

Octets part(const Octets& all, std::size_t from, std::size_t count) {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(from);
    return {begin, begin + static_cast<std::ptrdiff_t>(count)};
}

constexpr std::size_t kRadiotap = 23;

}  // namespace

TEST_CASE("a frame's check is CRC-32", "[ieee80211]") {
    CHECK(check_of("123456789") == 0xcbf43926);
    CHECK(check_of("") == 0);
}

TEST_CASE("addresses are made from those of IPv4", "[ieee80211]") {
    CHECK(mac_of(0x0a000007) == MacAddress{2, 0, 10, 0, 0, 7});
    CHECK(group_mac(0xe0800102) == MacAddress{1, 0, 0x5e, 0, 1, 2});
    CHECK(group_mac(0xe17f0102) == MacAddress{1, 0, 0x5e, 0x7f, 1, 2});
}

TEST_CASE("a data frame has radiotap, MAC header, SNAP, its packet and the check", "[ieee80211]") {
    const MacAddress station{2, 0, 10, 0, 0, 1}, point{2, 0, 0, 0, 0, 1}, other{2, 0, 10, 0, 0, 2};
    DataFrame frame{.to_access_point = true,
                    .again = true,
                    .duration = 44,
                    .transmitter = station,
                    .receiver = point,
                    .source = station,
                    .destination = other,
                    .network = point,
                    .sequence = 0xabc};
    const Octets packet{0x45, 1, 2, 3};
    const Octets up = capture_data(
        {.microseconds = 0x0102, .bits = 5.5e6, .short_preamble = true, .dbm = -61}, frame, packet);
    REQUIRE(up.size() == kRadiotap + 24 + 8 + packet.size() + 4);
    CHECK(part(up, 0, kRadiotap) == Octets{0, 0, 23, 0, 0x2f, 0,  0,    0,    2,    1, 0,         0,
                                           0, 0, 0,  0, 0x12, 11, 0x85, 0x09, 0xa0, 0, 0x100 - 61});
    CHECK(part(up, kRadiotap, 4) == Octets{0x08, 0x09, 44, 0});
    CHECK(part(up, kRadiotap + 4, 6) == Octets(point.begin(), point.end()));
    CHECK(part(up, kRadiotap + 10, 6) == Octets(station.begin(), station.end()));
    CHECK(part(up, kRadiotap + 16, 6) == Octets(other.begin(), other.end()));
    CHECK(part(up, kRadiotap + 22, 2) == Octets{0xc0, 0xab});
    CHECK(part(up, kRadiotap + 24, 8) == Octets{0xaa, 0xaa, 3, 0, 0, 0, 8, 0});
    CHECK(part(up, kRadiotap + 32, 4) == packet);
    const std::uint32_t check = frame_check(part(up, kRadiotap, up.size() - kRadiotap - 4));
    CHECK(up[up.size() - 4] == (check & 0xff));
    CHECK(up.back() == check >> 24);

    frame.to_access_point = false;
    frame.from_access_point = true;
    frame.again = false;
    const Octets down = capture_data({.bits = 54e6, .ofdm = true}, frame, packet);
    CHECK(down[17] == 108);
    CHECK(down[20] == 0xc0);
    CHECK(down[kRadiotap + 1] == 0x02);
    CHECK(part(down, kRadiotap + 16, 6) == Octets(station.begin(), station.end()));
    frame.from_access_point = false;
    CHECK(part(capture_data({}, frame, packet), kRadiotap + 16, 6) == Octets(point.begin(), point.end()));
}

TEST_CASE("an acknowledgement has 14 octets", "[ieee80211]") {
    const Octets ack = capture_ack({}, {2, 0, 10, 0, 0, 1});
    CHECK(ack.size() == kRadiotap + 14);
    CHECK(part(ack, kRadiotap, 10) == Octets{0xd4, 0, 0, 0, 2, 0, 10, 0, 0, 1});
}
