#pragma once
// Frames of IEEE 802.11 as a monitor captures them: radiotap header, MAC header, what is in it, check.
// Sources: IEEE 802.11-2016, clause 9 (frames); www.radiotap.org (fields); RFC 1042 (SNAP).

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace puckloop::protocols {

using MacAddress = std::array<std::uint8_t, 6>;
inline constexpr MacAddress kAllMac{0xff, 0xff, 0xff, 0xff, 0xff, 0xff};

/// Locally administered, from an IPv4 address.
MacAddress mac_of(std::uint32_t address);
/// Where packets for a group go (RFC 1112).
MacAddress group_mac(std::uint32_t group);

/// What radiotap reports beside the frame.
struct RadioReport {
    std::uint64_t microseconds = 0;  ///< when its first bit was sent
    double bits = 1e6;               ///< a second
    bool ofdm = false, short_preamble = false;
    int dbm = 0;  ///< received
};

struct DataFrame {
    bool to_access_point = false, from_access_point = false;  ///< neither: ad-hoc
    bool again = false;                                       ///< a further attempt
    std::uint16_t duration = 0;  ///< us for which it reserves the channel behind itself
    /// Who sends it and who is to read it now, where it is from and where it goes in the end.
    MacAddress transmitter{}, receiver{}, source{}, destination{};
    MacAddress network{};        ///< BSSID
    std::uint16_t sequence = 0;  ///< 0..4095
};

/// A frame with an IPv4 packet in it.
std::vector<std::uint8_t> capture_data(const RadioReport& radio, const DataFrame& frame,
                                       std::span<const std::uint8_t> packet);
std::vector<std::uint8_t> capture_ack(const RadioReport& radio, const MacAddress& receiver);

/// The check at a frame's end (CRC-32).
std::uint32_t frame_check(std::span<const std::uint8_t> octets);

}  // namespace puckloop::protocols
