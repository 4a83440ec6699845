#include "protocols/network/ieee80211.h"

#include <cmath>

namespace puckloop::protocols {

namespace {

using Octets = std::vector<std::uint8_t>;

constexpr std::size_t kRadiotap = 23;  // octets of the header that is written here

void little(Octets& out, std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i)
        out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

void append(Octets& out, std::span<const std::uint8_t> more) {
    out.insert(out.end(), more.begin(), more.end());
}

Octets radiotap(const RadioReport& radio) {
    constexpr std::uint32_t kTime = 1, kFlags = 2, kRate = 4, kChannel = 8, kSignal = 32;
    constexpr std::uint8_t kShortPreamble = 0x02, kWithCheck = 0x10;
    constexpr std::uint16_t kChannelSix = 2437, kCck = 0x0020, kOfdm = 0x0040, kTwoGigahertz = 0x0080;
    constexpr double kHalfMegabit = 5e5;
    Octets out;
    little(out, 0, 2);  // version
    little(out, kRadiotap, 2);
    little(out, kTime | kFlags | kRate | kChannel | kSignal, 4);
    little(out, radio.microseconds, 8);
    out.push_back(kWithCheck | (radio.short_preamble ? kShortPreamble : 0));
    out.push_back(static_cast<std::uint8_t>(std::lround(radio.bits / kHalfMegabit)));
    little(out, kChannelSix, 2);
    little(out, kTwoGigahertz | (radio.ofdm ? kOfdm : kCck), 2);
    out.push_back(static_cast<std::uint8_t>(static_cast<std::int8_t>(radio.dbm)));
    return out;
}

void end_frame(Octets& out) {
    little(out, frame_check(std::span(out).subspan(kRadiotap)), 4);
}

}  // namespace

MacAddress mac_of(std::uint32_t address) {
    return {0x02,
            0x00,
            static_cast<std::uint8_t>(address >> 24),
            static_cast<std::uint8_t>(address >> 16),
            static_cast<std::uint8_t>(address >> 8),
            static_cast<std::uint8_t>(address)};
}

MacAddress group_mac(std::uint32_t group) {
    return {0x01,
            0x00,
            0x5e,
            static_cast<std::uint8_t>(group >> 16 & 0x7f),
            static_cast<std::uint8_t>(group >> 8),
            static_cast<std::uint8_t>(group)};
}

std::uint32_t frame_check(std::span<const std::uint8_t> octets) {
    constexpr std::uint32_t kPolynomial = 0xedb88320;
    std::uint32_t check = ~std::uint32_t{0};
    for (const std::uint8_t octet : octets) {
        check ^= octet;
        for (int bit = 0; bit < 8; ++bit)
            check = check >> 1 ^ ((check & 1) != 0 ? kPolynomial : 0);
    }
    return ~check;
}

Octets capture_data(const RadioReport& radio, const DataFrame& frame, std::span<const std::uint8_t> packet) {
    constexpr std::uint8_t kData = 0x08, kToSystem = 0x01, kFromSystem = 0x02, kRetry = 0x08;
    constexpr std::array<std::uint8_t, 8> kSnapOfIp{0xaa, 0xaa, 0x03, 0x00, 0x00, 0x00, 0x08, 0x00};
    Octets out = radiotap(radio);
    out.push_back(kData);
    out.push_back(static_cast<std::uint8_t>((frame.to_access_point ? kToSystem : 0) |
                                            (frame.from_access_point ? kFromSystem : 0) |
                                            (frame.again ? kRetry : 0)));
    little(out, frame.duration, 2);
    // Table 9-26: the first address is always who reads it, the second who sends it.
    append(out, frame.receiver);
    append(out, frame.transmitter);
    append(out, frame.to_access_point     ? frame.destination
                : frame.from_access_point ? frame.source
                                          : frame.network);
    little(out, static_cast<std::uint64_t>(frame.sequence) << 4, 2);
    append(out, kSnapOfIp);
    append(out, packet);
    end_frame(out);
    return out;
}

Octets capture_ack(const RadioReport& radio, const MacAddress& receiver) {
    constexpr std::uint16_t kAck = 0x00d4;
    Octets out = radiotap(radio);
    little(out, kAck, 2);
    little(out, 0, 2);
    append(out, receiver);
    end_frame(out);
    return out;
}

}  // namespace puckloop::protocols
