#pragma once
// IPv4 packets with UDP, TCP and ICMP in them, as they go over a network.
// Sources: RFC 791 (IP), RFC 768 (UDP), RFC 9293 (TCP), RFC 792 (ICMP), RFC 1071 (checksum).
//
// Deviations: 1. IP options are skipped when read and never written. 2. Of TCP's options the maximum segment
// size alone is known.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::protocols {

/// An IPv4 address as a number: 10.0.0.1 is 0x0A000001.
using IpAddress = std::uint32_t;
using Octet = std::uint8_t;

inline constexpr Octet kIcmp = 1, kTcp = 6, kUdp = 17;
inline constexpr std::size_t kIpHeader = 20, kUdpHeader = 8, kTcpHeader = 20;
/// Of Ethernet and WiFi: most octets of one packet.
inline constexpr std::size_t kMtu = 1500;
inline constexpr std::size_t kMostDatagram = 65'535 - kIpHeader - kUdpHeader;

std::string to_text(IpAddress address);
/// "10.0.0.1"; nothing for what is no address in four decimal numbers.
std::optional<IpAddress> address_of(std::string_view text);

struct IpPacket {
    IpAddress from = 0, to = 0;
    Octet protocol = 0;
    Octet ttl = 64;
    Octet service = 0;  ///< type of service
    std::uint16_t id = 0;
    bool more = false;         ///< fragments follow
    std::uint16_t offset = 0;  ///< of this fragment, octets, a multiple of 8
    std::vector<Octet> payload{};

    bool whole() const { return !more && offset == 0; }
};
std::vector<Octet> encode(const IpPacket& packet);
/// Nothing for what is no IPv4 packet or has a wrong header checksum; octets beyond its length are left out.
std::optional<IpPacket> decode_ip(std::span<const Octet> octets);

struct UdpDatagram {
    std::uint16_t from_port = 0, to_port = 0;
    std::string data{};
};
std::vector<Octet> encode_udp(const UdpDatagram& datagram, IpAddress from, IpAddress to);
/// Of a whole packet; nothing for a wrong length or checksum.
std::optional<UdpDatagram> decode_udp(const IpPacket& packet);

inline constexpr Octet kFin = 1, kSyn = 2, kRst = 4, kPsh = 8, kAck = 16;
struct TcpSegment {
    std::uint16_t from_port = 0, to_port = 0;
    std::uint32_t sequence = 0, acknowledged = 0;
    Octet flags = 0;
    std::uint16_t window = 0;
    std::uint16_t most = 0;  ///< option: maximum segment size; 0: absent
    std::string data{};

    /// Sequence numbers that it takes.
    std::uint32_t length() const {
        return static_cast<std::uint32_t>(data.size()) + ((flags & kSyn) != 0) + ((flags & kFin) != 0);
    }
};
/// What answers a segment that belongs to no connection (RFC 9293, 3.10.7.1). Not for one that is a reset.
TcpSegment reset_for(const TcpSegment& segment);
std::vector<Octet> encode_tcp(const TcpSegment& segment, IpAddress from, IpAddress to);
std::optional<TcpSegment> decode_tcp(const IpPacket& packet);

inline constexpr Octet kUnreachable = 3, kPortUnreachable = 3;
inline constexpr Octet kEchoReply = 0, kEcho = 8;  ///< `rest`: identifier and sequence number
inline constexpr std::size_t kIcmpHeader = 8;
struct IcmpMessage {
    Octet type = 0, code = 0;
    std::uint32_t rest = 0;
    std::vector<Octet> data{};  ///< of an error: the packet that it is about, its beginning
};
std::vector<Octet> encode_icmp(const IcmpMessage& message);
std::optional<IcmpMessage> decode_icmp(const IpPacket& packet);

/// One line without commas: "UDP 10.0.0.1:5000 > 10.0.0.2:5000 12 octets".
std::string describe(const IpPacket& packet);

}  // namespace puckloop::protocols
