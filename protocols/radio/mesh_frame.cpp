#include "protocols/radio/mesh_frame.h"

#include <algorithm>
#include <array>

namespace puckloop::protocols {

namespace {

// Frame control (802.15.4, section 7.2.1.1): data, PAN id compressed, 64-bit addresses, version 2003.
constexpr std::uint16_t kControl = 0xCC41;
constexpr std::uint16_t kAskAck = 0x0020;
constexpr std::size_t kMacHeader = 21, kFcs = 2;
constexpr std::size_t kNetworkHeader = kMeshOverhead - kMacHeader - kFcs;
constexpr std::size_t kUsed = 22;  // octets of the network header that mean something
constexpr std::array<std::string_view, 4> kFaults{"none", "short", "check", "kind"};

/// Little-endian, as 802.15.4 sends numbers.
void put(std::vector<std::uint8_t>& out, std::uint64_t value, int octets) {
    for (int i = 0; i < octets; ++i)
        out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

struct Cursor {
    std::span<const std::uint8_t> octets;

    std::uint64_t take(std::size_t count) {
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < count; ++i)
            value |= std::uint64_t{octets[i]} << (8 * i);
        octets = octets.subspan(count);
        return value;
    }
    template <class Number>
    void get(Number& number) {
        number = static_cast<Number>(take(sizeof number));
    }
};

}  // namespace

std::string_view name_of(MeshFault fault) {
    return kFaults.at(static_cast<std::size_t>(fault));
}

std::uint16_t fcs_of(std::span<const std::uint8_t> octets) {
    // x^16 + x^12 + x^5 + 1, bits in the order of transmission, initially 0.
    constexpr std::uint16_t kPolynomial = 0x8408;
    std::uint16_t sum = 0;
    for (const std::uint8_t octet : octets) {
        sum = static_cast<std::uint16_t>(sum ^ octet);
        for (int bit = 0; bit < 8; ++bit)
            sum = static_cast<std::uint16_t>(sum & 1 ? sum >> 1 ^ kPolynomial : sum >> 1);
    }
    return sum;
}

std::vector<std::uint8_t> encode_mesh(const MeshFrame& frame) {
    std::vector<std::uint8_t> out;
    out.reserve(kMeshOverhead + frame.data.size());
    put(out, kControl | (frame.asks_ack ? kAskAck : 0), 2);
    put(out, frame.mac_sequence, 1);
    put(out, frame.pan, 2);
    put(out, frame.hop_to, 8);
    put(out, frame.hop_from, 8);
    put(out, static_cast<std::uint8_t>(frame.kind), 1);
    put(out, frame.options, 1);
    put(out, frame.radius, 1);
    put(out, frame.hops, 1);
    put(out, frame.sequence, 2);
    put(out, frame.origin, 8);
    put(out, frame.target, 8);
    out.resize(kMacHeader + kNetworkHeader, 0);
    const std::size_t size = std::min(frame.data.size(), kMostMeshData);
    out.insert(out.end(), frame.data.begin(), frame.data.begin() + static_cast<std::ptrdiff_t>(size));
    put(out, fcs_of(out), 2);
    return out;
}

MeshReading decode_mesh(std::span<const std::uint8_t> octets) {
    if (octets.size() < kMeshOverhead) return {MeshFault::Short, {}};
    const auto body = octets.first(octets.size() - kFcs);
    const auto fcs = octets.last(kFcs);
    if (fcs_of(body) != (fcs[0] | fcs[1] << 8)) return {MeshFault::Check, {}};
    Cursor in{body};
    MeshFrame frame;
    const auto control = static_cast<std::uint16_t>(in.take(2));
    frame.asks_ack = (control & kAskAck) != 0;
    in.get(frame.mac_sequence);
    in.get(frame.pan);
    in.get(frame.hop_to);
    in.get(frame.hop_from);
    const auto kind = static_cast<std::uint8_t>(in.take(1));
    in.get(frame.options);
    in.get(frame.radius);
    in.get(frame.hops);
    in.get(frame.sequence);
    in.get(frame.origin);
    in.get(frame.target);
    const auto rest = in.octets.subspan(kNetworkHeader - kUsed);
    if ((control & ~kAskAck) != kControl || kind > static_cast<std::uint8_t>(MeshKind::RemoteAtAnswer) ||
        rest.size() > kMostMeshData)
        return {MeshFault::Kind, {}};
    frame.kind = static_cast<MeshKind>(kind);
    frame.data.assign(rest.begin(), rest.end());
    return {MeshFault::None, std::move(frame)};
}

}  // namespace puckloop::protocols
