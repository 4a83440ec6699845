#pragma once
// The interfaces of a board on a network, as its kernel and the library inside its programs show them: `lo`
// and `wlan0`.

#include <net/if.h>

#include <array>
#include <cstdint>

namespace puckloop::linuxboard::wire {

inline constexpr int kLoopbackIndex = 1, kWirelessIndex = 2;
/// Where each board's name server is, as its /etc/resolv.conf says: 127.0.0.53.
inline constexpr std::uint32_t kResolver = 0x7f000035;
inline constexpr int kQueueLength = 1000;  // DEFAULT_TX_QUEUE_LEN

struct Interface {
    int index;
    const char* name;
    unsigned flags;
    int mtu;

    constexpr bool is_loopback() const { return index == kLoopbackIndex; }
    /// `own`: the board's address on the network.
    constexpr std::uint32_t address(std::uint32_t own) const { return is_loopback() ? 0x7f000001 : own; }
    constexpr int prefix(int of_network) const { return is_loopback() ? 8 : of_network; }
    constexpr std::uint32_t mask(int of_network) const {
        return ~std::uint32_t{0} << (32 - prefix(of_network));
    }
};
inline constexpr Interface kInterfaces[] = {
    {kLoopbackIndex, "lo", IFF_UP | IFF_LOOPBACK | IFF_RUNNING, 65'536},
    {kWirelessIndex, "wlan0", IFF_UP | IFF_BROADCAST | IFF_RUNNING | IFF_MULTICAST, 1500},
};

/// Of wlan0: a locally administered one, from the address.
constexpr std::array<unsigned char, 6> hardware_address(std::uint32_t own) {
    return {0x02,
            0x00,
            static_cast<unsigned char>(own >> 24),
            static_cast<unsigned char>(own >> 16),
            static_cast<unsigned char>(own >> 8),
            static_cast<unsigned char>(own)};
}

}  // namespace puckloop::linuxboard::wire
