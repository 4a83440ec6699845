// ICMP: echoes that the kernel answers and programs send (ping), and what errors are about.

#include "linuxboard/shim/network/network_stack.h"

#include <algorithm>
#include <cerrno>

namespace puckloop::linuxboard {

using cosim::Time;
using protocols::IcmpMessage;
using protocols::IpAddress;
using protocols::IpPacket;

namespace {
constexpr int kIdentifierAt = 16;  // bits of IcmpMessage::rest
}

/// `data` begins with the message's header, of which the kernel sets identifier and checksum.
int NetworkStack::send_echo(Socket& socket, Endpoint to, std::string_view data, Time now) {
    if (data.size() < protocols::kIcmpHeader || static_cast<protocols::Octet>(data[0]) != protocols::kEcho ||
        data[1] != 0)
        return EINVAL;
    if (data.size() > protocols::kMostDatagram) return EMSGSIZE;
    if (is_broadcast(to.address) && !socket.options.broadcast) return EACCES;
    const IpAddress source = source_for(to.address);
    if (source == 0) return ENETUNREACH;
    if (!socket.bound)
        if (const int error = bind_somewhere(socket, 0)) return error;
    constexpr std::size_t kSequence = 6;
    const auto octet = [&](std::size_t at) { return std::uint32_t{static_cast<protocols::Octet>(data[at])}; };
    IcmpMessage message{protocols::kEcho, 0, 0, {}};
    message.rest =
        std::uint32_t{socket.local.port} << kIdentifierAt | octet(kSequence) << 8 | octet(kSequence + 1);
    message.data.assign(data.begin() + protocols::kIcmpHeader, data.end());
    IpPacket packet;
    packet.from = source;
    packet.to = to.address;
    packet.protocol = protocols::kIcmp;
    packet.ttl = static_cast<protocols::Octet>(is_group(to.address) ? socket.options.group_time_to_live
                                                                    : socket.options.time_to_live);
    packet.service = static_cast<protocols::Octet>(socket.options.service);
    packet.payload = protocols::encode_icmp(message);
    emit(std::move(packet), now);
    return 0;
}

void NetworkStack::take_in(const IcmpMessage& message, const IpPacket& packet, Time now) {
    if (message.type == protocols::kUnreachable) return unreachable(message);
    if (message.type == protocols::kEcho) {
        if (is_for_many(packet.to)) return;  // icmp_echo_ignore_broadcasts
        IpPacket answer;
        answer.from = packet.to;
        answer.to = packet.from;
        answer.protocol = protocols::kIcmp;
        answer.payload = protocols::encode_icmp({protocols::kEchoReply, 0, message.rest, message.data});
        return emit(std::move(answer), now);
    }
    if (message.type != protocols::kEchoReply) return;
    const auto identifier = static_cast<std::uint16_t>(message.rest >> kIdentifierAt);
    for (const auto& [id, socket] : sockets_) {
        if (!socket->echo || !socket->bound || socket->local.port != identifier) continue;
        if (socket->connected && socket->peer.address != packet.from) continue;
        // As it came, with header and checksum.
        return put(*socket,
                   {{packet.from, 0},
                    {packet.payload.begin(), packet.payload.end()},
                    now,
                    packet.to,
                    packet.ttl,
                    packet.service},
                   counts_);
    }
}

}  // namespace puckloop::linuxboard
