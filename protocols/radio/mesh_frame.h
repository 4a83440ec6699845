#pragma once
// A frame of the XBee mesh on air: the PHY payload of IEEE 802.15.4 (2006, section 7.2) as a data frame with
// 64-bit addresses and compressed PAN id, then a network header, data, and the FCS.
//
// Digi does not publish DigiMesh's header. This one is our own; its length is Digi's: a module carries at
// most 73 bytes of data (NP) in the 127 octets of the PHY, so that 54 are headers and FCS, and a frame is as
// long on air as the real one.

#include "protocols/radio/xbee_message.h"

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace puckloop::protocols {

inline constexpr std::size_t kMeshOverhead = 54;  ///< octets of headers and FCS
inline constexpr std::size_t kMostMeshData = 73;  ///< NP

enum class MeshKind : std::uint8_t {
    Data,
    Acknowledge,    ///< of the network layer: from target back to origin
    RouteRequest,   ///< broadcast: who knows the way to `target`
    RouteReply,     ///< from the target of a request to its origin
    Discover,       ///< broadcast by ND and DN
    Discovered,     ///< the answer
    RemoteAt,       ///< an AT command for another module
    RemoteAtAnswer  ///< what it said
};

struct MeshFrame {
    // MAC: this hop.
    std::uint16_t pan = 0;
    std::uint64_t hop_to = kXBeeBroadcast;
    std::uint64_t hop_from = 0;
    std::uint8_t mac_sequence = 0;
    bool asks_ack = false;
    // Network: the whole way.
    MeshKind kind = MeshKind::Data;
    std::uint8_t options = 0;  ///< as XBeeTx: bit 0: no acknowledgement of the network layer
    std::uint8_t radius = 0;   ///< hops that it may still go
    std::uint8_t hops = 0;     ///< hops that it went before this one
    std::uint16_t sequence = 0;
    std::uint64_t origin = 0;
    std::uint64_t target = kXBeeBroadcast;
    std::vector<std::uint8_t> data;  ///< at most kMostMeshData

    bool broadcast() const { return target == kXBeeBroadcast || kind == MeshKind::RouteRequest; }
    bool operator==(const MeshFrame&) const = default;
};

enum class MeshFault : std::uint8_t {
    None,
    Short,  ///< fewer octets than headers and FCS
    Check,  ///< the FCS does not fit
    Kind    ///< no frame of this format
};

/// "none", "short", "check", "kind".
std::string_view name_of(MeshFault fault);

struct MeshReading {
    MeshFault fault = MeshFault::None;
    MeshFrame frame;  ///< only without a fault
};

/// The PHY payload.
std::vector<std::uint8_t> encode_mesh(const MeshFrame& frame);
MeshReading decode_mesh(std::span<const std::uint8_t> octets);

/// The frame check sequence of IEEE 802.15.4 (section 7.2.1.9) over `octets`; sent low octet first.
std::uint16_t fcs_of(std::span<const std::uint8_t> octets);

}  // namespace puckloop::protocols
