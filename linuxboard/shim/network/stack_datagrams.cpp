// UDP.

#include "linuxboard/shim/network/network_stack.h"

#include "protocols/network/dns_message.h"

#include <algorithm>
#include <cerrno>

namespace puckloop::linuxboard {

using cosim::Time;
using protocols::IpAddress;
using protocols::IpPacket;

namespace {
/// As reports can have it.
std::string printable(std::string name) {
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c <= ' ' || c > '~' || c == '\''; }, '?');
    return name;
}
}  // namespace

int NetworkStack::send_datagram(Socket& socket, Endpoint to, std::string_view data, Time now) {
    if (data.size() > protocols::kMostDatagram) return EMSGSIZE;
    if (to.port == 0) return EINVAL;
    if (to.address == 0) to.address = kLocalHost;  // as Linux: this host
    if (is_broadcast(to.address) && !socket.options.broadcast) return EACCES;
    const IpAddress source = source_for(to.address);
    if (leaves_loopback(socket, to.address)) return EINVAL;
    if (source == 0) return ENETUNREACH;
    if (!socket.bound)
        if (const int error = bind_somewhere(socket, 0)) return error;
    const bool own_address = socket.local.address != 0 && is_own(socket.local.address);
    IpPacket packet;
    packet.from = own_address ? socket.local.address : source;
    packet.to = to.address;
    packet.protocol = protocols::kUdp;
    packet.ttl = static_cast<std::uint8_t>(is_group(to.address) ? socket.options.group_time_to_live
                                                                : socket.options.time_to_live);
    packet.service = static_cast<protocols::Octet>(socket.options.service);
    packet.payload =
        protocols::encode_udp({socket.local.port, to.port, std::string(data)}, packet.from, packet.to);
    ++counts_.datagrams_sent;
    // With a time to live of 0 a packet stays on the board.
    if (packet.ttl == 0) {
        looped_.push_back({now + kLoopback, std::move(packet)});
        return 0;
    }
    emit(std::move(packet), now, !is_group(to.address) || socket.options.group_loop);
    return 0;
}

void NetworkStack::put(Socket& socket, Socket::Datagram datagram, NetworkCounts& counts) {
    const std::size_t size = datagram.data.size() + Socket::kDatagramCost;
    if (socket.read_shut) return;
    if (socket.queued + size > static_cast<std::size_t>(socket.options.receive_buffer)) {
        ++counts.datagrams_dropped;
        return;
    }
    socket.queue.push_back(std::move(datagram));
    socket.queued += size;
    ++socket.activity;
    ++counts.datagrams_received;
}

/// One to many goes to every socket that has the port, one to one to the socket that fits best.
void NetworkStack::deliver(const protocols::UdpDatagram& datagram, const IpPacket& packet, Time now) {
    if (packet.to == kResolver && datagram.to_port == protocols::kDnsPort)
        return answer_question(datagram, packet.from, now);
    const Endpoint from{packet.from, datagram.from_port};
    const Socket::Datagram taken{from, datagram.data, now, packet.to, packet.ttl, packet.service};
    const bool for_many = is_for_many(packet.to);
    std::vector<Socket*> best;
    int best_score = -1;
    for (const auto& [id, entry] : sockets_) {
        Socket& socket = *entry;
        if (socket.stream || socket.echo || socket.netlink || !socket.bound ||
            socket.local.port != datagram.to_port)
            continue;
        if (socket.local.address != 0 && socket.local.address != packet.to) continue;
        if (socket.connected && socket.peer != from) continue;
        if (is_group(packet.to)) {
            // As Linux has it (IP_MULTICAST_ALL): a group that any socket of the board has joined.
            const bool joined = std::any_of(sockets_.begin(), sockets_.end(), [&](const auto& other) {
                return other.second->groups.contains(packet.to);
            });
            if (!joined || (!socket.options.all_groups && !socket.groups.contains(packet.to))) continue;
        }
        if (for_many) {
            put(socket, taken, counts_);
            continue;
        }
        const int score = (socket.local.address != 0 ? 1 : 0) + (socket.connected ? 2 : 0);
        if (score < best_score) continue;
        if (score > best_score || !socket.options.reuse_port) best.clear();  // of equals the last
        best.push_back(&socket);
        best_score = score;
    }
    if (for_many) return;
    if (!best.empty())
        return put(*best[share_of({packet.to, datagram.to_port}, from, best.size())], taken, counts_);
    ++counts_.no_port;
    protocols::IcmpMessage message{protocols::kUnreachable, protocols::kPortUnreachable, 0, {}};
    message.data = protocols::encode(packet);
    message.data.resize(std::min(message.data.size(), protocols::kIpHeader + protocols::kUdpHeader));
    IpPacket answer;
    answer.from = packet.to;
    answer.to = packet.from;
    answer.protocol = protocols::kIcmp;
    answer.payload = protocols::encode_icmp(message);
    emit(std::move(answer), now);
}

void NetworkStack::answer_question(const protocols::UdpDatagram& question, IpAddress from, Time now) {
    const auto answer = names_.answer(question.data);
    if (!answer) return;
    const std::string name = printable(answer->name);
    if (silence_ && silence_(now, name)) return;
    constexpr std::size_t kMostUnknown = 32;
    if (answer->unknown && unknown_names_.size() < kMostUnknown) unknown_names_.insert(name);
    IpPacket packet;
    packet.from = kResolver;
    packet.to = from;
    packet.protocol = protocols::kUdp;
    packet.payload =
        protocols::encode_udp({protocols::kDnsPort, question.from_port, answer->datagram}, kResolver, from);
    emit(std::move(packet), now);
}

/// The port that a datagram was for does not exist: its sender's next call fails, if it is connected.
void NetworkStack::unreachable(const protocols::IcmpMessage& message) {
    if (message.type != protocols::kUnreachable ||
        message.data.size() < protocols::kIpHeader + protocols::kUdpHeader)
        return;
    const auto word = [&](std::size_t place, int octets) {
        std::uint32_t value = 0;
        for (int i = 0; i < octets; ++i)
            value = value << 8 | message.data[place + static_cast<std::size_t>(i)];
        return value;
    };
    constexpr std::size_t kProtocol = 9, kTo = 16, kFromPort = 20, kToPort = 22;
    if (message.data[kProtocol] != protocols::kUdp) return;
    const Endpoint to{word(kTo, 4), static_cast<std::uint16_t>(word(kToPort, 2))};
    for (const auto& [id, socket] : sockets_) {
        if (socket->stream || !socket->connected || socket->local.port != word(kFromPort, 2)) continue;
        if (socket->peer != to) continue;
        socket->error = ECONNREFUSED;
        ++socket->activity;
    }
}

}  // namespace puckloop::linuxboard
