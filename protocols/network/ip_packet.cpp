#include "protocols/network/ip_packet.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace puckloop::protocols {

namespace {

constexpr std::uint16_t kMoreFragments = 0x2000, kDontFragment = 0x4000, kOffsetMask = 0x1fff;
constexpr std::size_t kOffsetUnit = 8;
constexpr Octet kVersionAndLength = 0x45;
constexpr Octet kEndOfOptions = 0, kNoOption = 1, kSegmentSize = 2;
constexpr std::size_t kSegmentSizeLength = 4;

void put(std::vector<Octet>& out, std::uint32_t value, int octets) {
    for (int i = octets - 1; i >= 0; --i)
        out.push_back(static_cast<Octet>(value >> (8 * i)));
}

std::uint32_t get(std::span<const Octet> octets, std::size_t at, int count) {
    std::uint32_t value = 0;
    for (int i = 0; i < count; ++i)
        value = value << 8 | octets[at + static_cast<std::size_t>(i)];
    return value;
}

std::uint16_t get16(std::span<const Octet> octets, std::size_t at) {
    return static_cast<std::uint16_t>(get(octets, at, 2));
}

std::uint32_t sum_of(std::span<const Octet> octets) {
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < octets.size(); ++i)
        sum += i % 2 == 0 ? octets[i] << 8 : octets[i];
    return sum;
}

std::uint16_t folded(std::uint32_t sum) {
    while (sum > 0xffff)
        sum = (sum & 0xffff) + (sum >> 16);
    return static_cast<std::uint16_t>(~sum);
}

/// With the pseudo header of UDP and TCP.
std::uint16_t checksum(std::span<const Octet> octets, IpAddress from, IpAddress to, Octet protocol) {
    std::uint32_t sum = sum_of(octets) + protocol + static_cast<std::uint32_t>(octets.size());
    for (const IpAddress address : {from, to})
        sum += (address >> 16) + (address & 0xffff);
    return folded(sum);
}

void set16(std::vector<Octet>& octets, std::size_t at, std::uint16_t value) {
    octets[at] = static_cast<Octet>(value >> 8);
    octets[at + 1] = static_cast<Octet>(value);
}

std::string text_of(std::span<const Octet> octets) {
    return {octets.begin(), octets.end()};
}

std::string flags_text(Octet flags) {
    std::string text;
    constexpr std::pair<Octet, const char*> kNames[] = {
        {kSyn, "SYN"}, {kFin, "FIN"}, {kRst, "RST"}, {kPsh, "PSH"}, {kAck, "ACK"}};
    for (const auto& [flag, name] : kNames)
        if ((flags & flag) != 0) text += (text.empty() ? "" : "+") + std::string(name);
    return text.empty() ? "no flags" : text;
}

}  // namespace

std::string to_text(IpAddress address) {
    return fmt::format("{}.{}.{}.{}", address >> 24, address >> 16 & 0xff, address >> 8 & 0xff,
                       address & 0xff);
}

std::optional<IpAddress> address_of(std::string_view text) {
    IpAddress address = 0;
    const char* at = text.data();
    const char* const end = at + text.size();
    for (int part = 0; part < 4; ++part) {
        if (part > 0 && (at == end || *at++ != '.')) return std::nullopt;
        unsigned value = 0;
        const auto read = std::from_chars(at, end, value);
        if (read.ec != std::errc() || value > 255 || read.ptr - at > 3) return std::nullopt;
        at = read.ptr;
        address = address << 8 | value;
    }
    return at == end ? std::optional(address) : std::nullopt;
}

std::vector<Octet> encode(const IpPacket& packet) {
    std::vector<Octet> out;
    out.reserve(kIpHeader + packet.payload.size());
    put(out, kVersionAndLength, 1);
    put(out, packet.service, 1);
    put(out, static_cast<std::uint32_t>(kIpHeader + packet.payload.size()), 2);
    put(out, packet.id, 2);
    const bool may_split = packet.protocol == kUdp;
    put(out,
        static_cast<std::uint32_t>(packet.offset / kOffsetUnit) | (packet.more ? kMoreFragments : 0u) |
            (may_split ? 0u : kDontFragment),
        2);
    put(out, packet.ttl, 1);
    put(out, packet.protocol, 1);
    put(out, 0, 2);
    put(out, packet.from, 4);
    put(out, packet.to, 4);
    set16(out, 10, folded(sum_of(out)));
    out.insert(out.end(), packet.payload.begin(), packet.payload.end());
    return out;
}

std::optional<IpPacket> decode_ip(std::span<const Octet> octets) {
    if (octets.size() < kIpHeader || octets[0] >> 4 != 4) return std::nullopt;
    const std::size_t header = 4u * (octets[0] & 0xfu), length = get16(octets, 2);
    if (header < kIpHeader || header > length || length > octets.size()) return std::nullopt;
    if (folded(sum_of(octets.first(header))) != 0) return std::nullopt;
    const std::uint16_t fragment = get16(octets, 6);
    IpPacket packet;
    packet.service = octets[1];
    packet.id = get16(octets, 4);
    packet.more = (fragment & kMoreFragments) != 0;
    packet.offset = static_cast<std::uint16_t>((fragment & kOffsetMask) * kOffsetUnit);
    packet.ttl = octets[8];
    packet.protocol = octets[9];
    packet.from = get(octets, 12, 4);
    packet.to = get(octets, 16, 4);
    const auto payload = octets.subspan(header, length - header);
    packet.payload.assign(payload.begin(), payload.end());
    return packet;
}

std::vector<Octet> encode_udp(const UdpDatagram& datagram, IpAddress from, IpAddress to) {
    std::vector<Octet> out;
    put(out, datagram.from_port, 2);
    put(out, datagram.to_port, 2);
    put(out, static_cast<std::uint32_t>(kUdpHeader + datagram.data.size()), 2);
    put(out, 0, 2);
    out.insert(out.end(), datagram.data.begin(), datagram.data.end());
    const std::uint16_t sum = checksum(out, from, to, kUdp);
    set16(out, 6, sum == 0 ? 0xffff : sum);  // 0 means that there is none
    return out;
}

std::optional<UdpDatagram> decode_udp(const IpPacket& packet) {
    const std::span<const Octet> octets = packet.payload;
    if (octets.size() < kUdpHeader) return std::nullopt;
    const std::size_t length = get16(octets, 4);
    if (length < kUdpHeader || length > octets.size()) return std::nullopt;
    if (get16(octets, 6) != 0 && checksum(octets.first(length), packet.from, packet.to, kUdp) != 0)
        return std::nullopt;
    return UdpDatagram{get16(octets, 0), get16(octets, 2),
                       text_of(octets.subspan(kUdpHeader, length - kUdpHeader))};
}

TcpSegment reset_for(const TcpSegment& segment) {
    TcpSegment reset;
    reset.from_port = segment.to_port;
    reset.to_port = segment.from_port;
    reset.flags = kRst;
    if ((segment.flags & kAck) != 0) {
        reset.sequence = segment.acknowledged;
    } else {
        reset.flags |= kAck;
        reset.acknowledged = segment.sequence + segment.length();
    }
    return reset;
}

std::vector<Octet> encode_tcp(const TcpSegment& segment, IpAddress from, IpAddress to) {
    std::vector<Octet> out;
    put(out, segment.from_port, 2);
    put(out, segment.to_port, 2);
    put(out, segment.sequence, 4);
    put(out, segment.acknowledged, 4);
    const std::size_t header = kTcpHeader + (segment.most != 0 ? kSegmentSizeLength : 0);
    put(out, static_cast<std::uint32_t>(header / 4) << 4, 1);
    put(out, segment.flags, 1);
    put(out, segment.window, 2);
    put(out, 0, 4);
    if (segment.most != 0) {
        put(out, kSegmentSize, 1);
        put(out, kSegmentSizeLength, 1);
        put(out, segment.most, 2);
    }
    out.insert(out.end(), segment.data.begin(), segment.data.end());
    set16(out, 16, checksum(out, from, to, kTcp));
    return out;
}

std::optional<TcpSegment> decode_tcp(const IpPacket& packet) {
    const std::span<const Octet> octets = packet.payload;
    if (octets.size() < kTcpHeader) return std::nullopt;
    const std::size_t header = 4u * (octets[12] >> 4);
    if (header < kTcpHeader || header > octets.size()) return std::nullopt;
    if (checksum(octets, packet.from, packet.to, kTcp) != 0) return std::nullopt;
    TcpSegment segment;
    segment.from_port = get16(octets, 0);
    segment.to_port = get16(octets, 2);
    segment.sequence = get(octets, 4, 4);
    segment.acknowledged = get(octets, 8, 4);
    segment.flags = octets[13];
    segment.window = get16(octets, 14);
    for (std::size_t at = kTcpHeader; at < header && octets[at] != kEndOfOptions;) {
        if (octets[at] == kNoOption) {
            ++at;
            continue;
        }
        const std::size_t length = at + 1 < header ? octets[at + 1] : 0;
        if (length < 2 || at + length > header) return std::nullopt;
        if (octets[at] == kSegmentSize && length == kSegmentSizeLength) segment.most = get16(octets, at + 2);
        at += length;
    }
    segment.data = text_of(octets.subspan(header));
    return segment;
}

std::vector<Octet> encode_icmp(const IcmpMessage& message) {
    std::vector<Octet> out;
    put(out, message.type, 1);
    put(out, message.code, 1);
    put(out, 0, 2);
    put(out, message.rest, 4);
    out.insert(out.end(), message.data.begin(), message.data.end());
    set16(out, 2, folded(sum_of(out)));
    return out;
}

std::optional<IcmpMessage> decode_icmp(const IpPacket& packet) {
    const std::span<const Octet> octets = packet.payload;
    if (octets.size() < kIcmpHeader || folded(sum_of(octets)) != 0) return std::nullopt;
    IcmpMessage message{octets[0], octets[1], get(octets, 4, 4), {}};
    message.data.assign(octets.begin() + kIcmpHeader, octets.end());
    return message;
}

std::string describe(const IpPacket& packet) {
    const std::string from = to_text(packet.from), to = to_text(packet.to);
    if (!packet.whole())
        return fmt::format("fragment {} > {} id {} octets {} to {}", from, to, packet.id, packet.offset,
                           packet.offset + packet.payload.size());
    if (packet.protocol == kUdp)
        if (const auto udp = decode_udp(packet))
            return fmt::format("UDP {}:{} > {}:{} {} octets", from, udp->from_port, to, udp->to_port,
                               udp->data.size());
    if (packet.protocol == kTcp)
        if (const auto tcp = decode_tcp(packet))
            return fmt::format("TCP {}:{} > {}:{} {} seq {} ack {} window {} {} octets", from, tcp->from_port,
                               to, tcp->to_port, flags_text(tcp->flags), tcp->sequence, tcp->acknowledged,
                               tcp->window, tcp->data.size());
    if (packet.protocol == kIcmp)
        if (const auto icmp = decode_icmp(packet))
            return fmt::format("ICMP {} > {} type {} code {}", from, to, icmp->type, icmp->code);
    return fmt::format("protocol {} {} > {} damaged {} octets", packet.protocol, from, to,
                       packet.payload.size());
}

}  // namespace puckloop::protocols
