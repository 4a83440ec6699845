// Packets: where they go, fragments, and who gets what comes in. The sockets' calls that all kinds share.

#include "linuxboard/shim/network/network_stack.h"

#include "base/error.h"
#include "base/json.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

namespace puckloop::linuxboard {

using cosim::kNever;
using cosim::Time;
using protocols::IpAddress;
using protocols::IpPacket;

namespace {
constexpr IpAddress kEverybody = 0xffffffff;
constexpr std::size_t kFragment = (protocols::kMtu - protocols::kIpHeader) / 8 * 8;
constexpr Time kFragmentLife = 30 * cosim::kSecond;  // ipfrag_time
constexpr std::size_t kMostFragmented = 64;
constexpr std::uint16_t kFirstPort = 32'768, kPorts = 28'232;  // ip_local_port_range

bool is_opening(const TcpConnection& tcp) {
    return !tcp.synchronised() && tcp.state() != TcpConnection::State::Closed;
}

bool is_local(IpAddress address) {
    return address >> 24 == kLocalHost >> 24;
}

IpAddress read_address(const std::string& text) {
    const auto address = protocols::address_of(text);
    if (!address) throw InputError("", "linux.network", "'" + text + "' is no address", "such as 10.0.0.1");
    return *address;
}
}  // namespace

NetworkPlace place_of(const NetworkSpec& spec) {
    return {read_address(spec.address), ~std::uint32_t{0} << (32 - spec.prefix)};
}

NetworkStack::NetworkStack(const NetworkSpec& spec, RandomStream random)
    : place_(place_of(spec)), names_(spec), random_(random) {
    for (const NetworkName& one : spec.names)
        known_.insert(read_address(one.address));
    next_port_ = static_cast<std::uint16_t>(kFirstPort + random_.below(kPorts));
}

bool NetworkStack::is_own(IpAddress address) const {
    return address == place_.address || is_local(address);
}

bool NetworkStack::is_broadcast(IpAddress address) const {
    return address == kEverybody || address == place_.broadcast();
}

IpAddress NetworkStack::source_for(IpAddress to) const {
    if (is_local(to)) return kLocalHost;
    if (to == place_.address || is_for_many(to) || place_.contains(to)) return place_.address;
    return 0;
}

void NetworkStack::emit(IpPacket packet, Time now, bool loop) {
    packet.id = next_packet_++;
    const bool for_many = is_for_many(packet.to);
    if (is_own(packet.to) || (for_many && loop)) looped_.push_back({now + kLoopback, packet});
    if (is_own(packet.to)) return;
    if (!for_many && !known_.contains(packet.to)) {
        ++counts_.unreachable;
        return;
    }
    std::vector<std::uint8_t> all = std::move(packet.payload);
    for (std::size_t begin = 0; begin == 0 || begin < all.size();) {
        const bool fits = begin == 0 && all.size() <= protocols::kMtu - protocols::kIpHeader;
        const std::size_t size = fits ? all.size() : std::min(kFragment, all.size() - begin);
        packet.offset = static_cast<std::uint16_t>(begin);
        packet.more = begin + size < all.size();
        const auto first = all.begin() + static_cast<std::ptrdiff_t>(begin);
        packet.payload.assign(first, first + static_cast<std::ptrdiff_t>(size));
        out_.push_back({now, cosim::Octets(protocols::encode(packet))});
        ++counts_.packets_sent;
        ++wireless_.packets_sent;
        wireless_.octets_sent += protocols::kIpHeader + size;
        begin += std::max<std::size_t>(size, 1);
    }
}

void NetworkStack::receive_packet(std::span<const std::uint8_t> octets, Time now) {
    next_event_.reset();
    const auto packet = protocols::decode_ip(octets);
    if (!packet) {
        ++counts_.damaged;
        return;
    }
    if (packet->to != place_.address && !is_for_many(packet->to)) return;
    ++counts_.packets_received;
    ++wireless_.packets_received;
    wireless_.octets_received += octets.size();
    if (packet->whole()) return take_in(*packet, now);
    if (const auto complete = reassemble(*packet, now)) take_in(*complete, now);
}

std::optional<IpPacket> NetworkStack::reassemble(const IpPacket& fragment, Time now) {
    std::erase_if(fragments_, [now](const auto& one) { return one.second.since + kFragmentLife <= now; });
    const std::tuple key{fragment.from, fragment.id, fragment.protocol};
    if (!fragments_.contains(key) && fragments_.size() >= kMostFragmented) return std::nullopt;
    Fragments& kept = fragments_.try_emplace(key, Fragments{now, {}, {}}).first->second;
    kept.parts.insert_or_assign(fragment.offset, fragment.payload);
    if (!fragment.more) kept.size = fragment.offset + fragment.payload.size();
    if (!kept.size) return std::nullopt;
    IpPacket whole = fragment;
    whole.payload.clear();
    whole.offset = 0;
    whole.more = false;
    for (const auto& [offset, part] : kept.parts) {
        if (offset != whole.payload.size()) return std::nullopt;
        whole.payload.insert(whole.payload.end(), part.begin(), part.end());
    }
    if (whole.payload.size() != *kept.size) return std::nullopt;
    fragments_.erase(key);
    return whole;
}

void NetworkStack::take_in(const IpPacket& packet, Time now) {
    switch (packet.protocol) {
    case protocols::kUdp:
        if (const auto datagram = protocols::decode_udp(packet)) return deliver(*datagram, packet, now);
        break;
    case protocols::kTcp:
        if (is_for_many(packet.to)) return;
        if (const auto segment = protocols::decode_tcp(packet)) return deliver(*segment, packet, now);
        break;
    case protocols::kIcmp:
        if (const auto message = protocols::decode_icmp(packet)) return take_in(*message, packet, now);
        break;
    default:
        return;
    }
    ++counts_.damaged;
}

void NetworkStack::advance(Time now) {
    next_event_.reset();
    while (!looped_.empty() && looped_.front().time <= now) {
        const Looped one = std::move(looped_.front());
        looped_.pop_front();
        for (auto [packets, octets] : {std::pair{&loopback_.packets_sent, &loopback_.octets_sent},
                                       std::pair{&loopback_.packets_received, &loopback_.octets_received}}) {
            ++*packets;
            *octets += protocols::kIpHeader + one.packet.payload.size();
        }
        take_in(one.packet, now);
    }
    std::vector<int> due;
    for (const auto& [id, socket] : sockets_) {
        if (socket->unreachable_at <= now) {
            socket->unreachable_at = kNever;
            socket->tcp->fail(EHOSTUNREACH);
        }
        if (socket->tcp && socket->tcp->next_event() <= now) due.push_back(id);
    }
    for (const int id : due) {
        Socket& socket = at(id);
        const bool was_open = socket.tcp->synchronised();
        socket.tcp->advance(now);
        flush(socket, now);
        // Nobody took the answer: it leaves the backlog.
        if (!was_open && socket.tcp->state() == TcpConnection::State::Closed) socket.listener = -1;
    }
    forget_closed();
}

Time NetworkStack::next_event() const {
    if (next_event_) return *next_event_;
    Time next = looped_.empty() ? kNever : looped_.front().time;
    for (const auto& [id, socket] : sockets_) {
        next = std::min(next, socket->unreachable_at);
        if (socket->tcp) next = std::min(next, socket->tcp->next_event());
    }
    next_event_ = next;
    return next;
}

Socket& NetworkStack::add(SocketKind kind) {
    next_event_.reset();
    const bool stream = kind == SocketKind::Stream;
    auto socket = std::make_unique<Socket>();
    socket->id = next_id_++;
    socket->stream = stream;
    socket->echo = kind == SocketKind::Echo;
    socket->netlink = kind == SocketKind::Netlink;
    if (stream) {
        socket->options.send_buffer = 131'072;
        socket->options.receive_buffer = 131'072;
    }
    return *(sockets_[socket->id] = std::move(socket));
}

int NetworkStack::open(SocketKind kind) {
    used_ = true;
    return add(kind).id;
}

void NetworkStack::close(int id, Time now) {
    Socket& socket = at(id);
    socket.open = false;
    if (socket.stream)
        close_stream(socket, now);
    else
        sockets_.erase(id);
    forget_closed();
}

void NetworkStack::close_all(Time now) {
    std::vector<int> open;
    for (const auto& [id, socket] : sockets_)
        if (socket->open) open.push_back(id);
    for (const int id : open)
        if (sockets_.contains(id)) close(id, now);
}

void NetworkStack::forget_closed() {
    for (auto it = sockets_.begin(); it != sockets_.end();) {
        const Socket& socket = *it->second;
        const bool over = !socket.tcp || socket.tcp->state() == TcpConnection::State::Closed;
        if (socket.open || socket.listener >= 0 || !over) {
            ++it;
            continue;
        }
        if (socket.tcp) ended_ += socket.tcp->counts();
        it = sockets_.erase(it);
    }
}

int NetworkStack::send(int id, std::optional<Endpoint> to, std::string_view data, std::size_t& taken,
                       Time now, bool more) {
    Socket& socket = at(id);
    taken = 0;
    if (socket.stream) return send_stream(socket, data, taken, now, more);
    if (const int error = std::exchange(socket.error, 0)) return error;
    if (socket.netlink) {
        taken = data.size();
        return send_netlink(socket, data, now);
    }
    if (socket.write_shut) return EPIPE;
    if (!to && !socket.connected) return EDESTADDRREQ;
    const Endpoint receiver = to ? *to : socket.peer;
    const int error =
        socket.echo ? send_echo(socket, receiver, data, now) : send_datagram(socket, receiver, data, now);
    if (error == 0) taken = data.size();
    return error;
}

int NetworkStack::receive(int id, std::size_t most, bool peek, Received& received, Time now) {
    Socket& socket = at(id);
    if (!socket.stream) {
        if (const int error = std::exchange(socket.error, 0)) return error;
        if (socket.queue.empty()) return socket.read_shut ? 0 : EAGAIN;
        Socket::Datagram& first = socket.queue.front();
        received.from = first.from;
        received.size = first.data.size();
        received.time = first.time;
        received.to = first.to;
        received.time_to_live = first.time_to_live;
        received.service = first.service;
        received.data = first.data.substr(0, most);
        if (peek) return 0;
        socket.queued -= first.data.size() + Socket::kDatagramCost;
        socket.queue.pop_front();
        return 0;
    }
    if (!socket.tcp && socket.read_shut) return 0;
    if (socket.listening || !socket.tcp) return ENOTCONN;
    // What came is read also after shutdown(SHUT_RD).
    if (socket.tcp->readable() > 0) {
        received.data = socket.tcp->read(most, peek, now);
        received.size = received.data.size();
        received.from = socket.tcp->peer();
        flush(socket, now);
        return 0;
    }
    if (const int error = take_error(socket)) return error;
    if (is_opening(*socket.tcp)) return EAGAIN;
    return socket.tcp->at_end() || socket.read_shut ? 0 : EAGAIN;
}

int NetworkStack::shutdown(int id, int how, Time now) {
    Socket& socket = at(id);
    if (how != SHUT_RD && how != SHUT_WR && how != SHUT_RDWR) return EINVAL;
    if (socket.netlink) return EOPNOTSUPP;
    if (socket.listening) {
        if (how != SHUT_WR) {
            close_stream(socket, now);
            ++socket.activity;
        }
        return 0;
    }
    if (how != SHUT_WR) socket.read_shut = true;
    if (how != SHUT_RD) socket.write_shut = true;
    ++socket.activity;
    // It is shut all the same, as in Linux.
    if (socket.stream ? !socket.tcp || socket.tcp->state() == TcpConnection::State::Closed
                      : !socket.connected)
        return ENOTCONN;
    if (!socket.stream) return 0;
    if (how != SHUT_WR) socket.tcp->shut_read(now);
    if (how != SHUT_RD) socket.tcp->shut_write(now);
    flush(socket, now);
    return 0;
}

int NetworkStack::name_of(int id, bool peer, Endpoint& name) const {
    const Socket& socket = at(id);
    if (!peer) {
        name = socket.local;
        return 0;
    }
    if (socket.stream ? !socket.tcp || !socket.tcp->synchronised() : !socket.connected) return ENOTCONN;
    name = socket.stream ? socket.tcp->peer() : socket.peer;
    return 0;
}

int NetworkStack::events(int id) const {
    const Socket& socket = at(id);
    int events = 0;
    if (!socket.stream) {
        if (!socket.queue.empty() || socket.read_shut) events |= POLLIN | POLLRDNORM;
        if (socket.read_shut) events |= POLLRDHUP;
        if (socket.read_shut && socket.write_shut) events |= POLLHUP;
        if (socket.error != 0) events |= POLLERR;
        return events | POLLOUT | POLLWRNORM;
    }
    if (socket.listening) return socket.ready.empty() ? 0 : POLLIN | POLLRDNORM;
    if (!socket.tcp) return POLLOUT | POLLWRNORM | POLLHUP;
    const TcpConnection& tcp = *socket.tcp;
    const bool over = tcp.state() == TcpConnection::State::Closed;
    if (is_opening(tcp)) return 0;
    const auto enough = static_cast<std::size_t>(socket.options.low_water);
    if (tcp.readable() >= enough || tcp.peer_done() || over) events |= POLLIN | POLLRDNORM;
    if (tcp.peer_done() || over) events |= POLLRDHUP;
    if (over || (tcp.peer_done() && tcp.write_done())) events |= POLLHUP;
    if (tcp.error() != 0 || socket.error != 0) events |= POLLERR;
    // Room for a third: sk_stream_is_writeable().
    constexpr std::size_t kPart = 3;
    if (over || tcp.write_done() || kPart * tcp.room() >= socket.tcp->unacknowledged() + tcp.room())
        events |= POLLOUT | POLLWRNORM;
    return events;
}

std::uint32_t NetworkStack::activity(int id) const {
    const Socket& socket = at(id);
    return socket.activity + (socket.tcp ? socket.tcp->activity() : 0);
}

std::size_t NetworkStack::readable(int id) const {
    const Socket& socket = at(id);
    if (!socket.stream) return socket.queue.empty() ? 0 : socket.queue.front().data.size();
    return socket.tcp ? socket.tcp->readable() : 0;
}

std::size_t NetworkStack::unsent(int id) const {
    const Socket& socket = at(id);
    return socket.tcp ? socket.tcp->unacknowledged() : 0;
}

std::string NetworkStack::report() const {
    TcpCounts tcp = ended_;
    for (const auto& [id, socket] : sockets_)
        if (socket->tcp) tcp += socket->tcp->counts();
    const nlohmann::ordered_json report = {{"address", protocols::to_text(place_.address)},
                                           {"packets_sent", counts_.packets_sent},
                                           {"packets_received", counts_.packets_received},
                                           {"damaged", counts_.damaged},
                                           {"unreachable", counts_.unreachable},
                                           {"udp",
                                            {{"sent", counts_.datagrams_sent},
                                             {"received", counts_.datagrams_received},
                                             {"dropped", counts_.datagrams_dropped},
                                             {"no_port", counts_.no_port}}},
                                           {"tcp",
                                            {{"connections", counts_.connections},
                                             {"segments_sent", tcp.sent},
                                             {"segments_received", tcp.received},
                                             {"retransmitted", tcp.retransmitted},
                                             {"timeouts", tcp.timeouts},
                                             {"fast_retransmits", tcp.fast_retransmits},
                                             {"octets_sent", tcp.octets_sent},
                                             {"octets_received", tcp.octets_received}}}};
    return report.dump();
}

}  // namespace puckloop::linuxboard
