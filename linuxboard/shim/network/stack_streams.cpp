// TCP's sockets: which segment is whose, connecting, accepting, closing.

#include "linuxboard/shim/network/network_stack.h"

#include <algorithm>
#include <cerrno>

namespace puckloop::linuxboard {

using cosim::kNever;
using cosim::Time;
using protocols::IpAddress;
using protocols::IpPacket;
using protocols::TcpSegment;

namespace {
/// An address that nobody answers for: three questions, a second apart (neigh/mcast_solicit, retrans_time).
constexpr Time kAsking = 3 * cosim::kSecond;
constexpr int kMostBacklog = 4096;  // net.core.somaxconn
/// Of a buffer's size as programs see it, half is for data (tcp_adv_win_scale).
constexpr int kShareOfData = 2;

TcpConnection::Settings settings_of(const SocketOptions& options) {
    constexpr std::size_t kWidest = 65'535;
    const auto half = [](int size) { return static_cast<std::size_t>(std::max(size / kShareOfData, 1)); };
    return {.send_buffer = half(options.send_buffer),
            .receive_buffer = std::min(half(options.receive_buffer), kWidest),
            .no_delay = options.no_delay,
            .cork = options.cork};
}
}  // namespace

void NetworkStack::set_patience(TcpConnection::Settings& settings, const SocketOptions& options) {
    settings.keep_alive = options.keep_alive;
    settings.keep_idle = options.keep_idle * cosim::kSecond;
    settings.keep_interval = options.keep_interval * cosim::kSecond;
    settings.keep_count = options.keep_count;
    settings.user_timeout = options.user_timeout * cosim::kMillisecond;
    settings.syn_attempts = options.syn_count;
    if (options.most_segment != 0)
        settings.most_segment =
            std::min<std::size_t>(static_cast<std::size_t>(options.most_segment), TcpConnection::kSegment);
}

int NetworkStack::connect(int id, Endpoint to, Time now) {
    Socket& socket = at(id);
    if (socket.netlink) {
        if (to.address != 0) return ECONNREFUSED;  // nobody but the kernel answers
        if (!socket.bound) bind_netlink(socket, 0);
        socket.connected = true;
        return 0;
    }
    if (to.address == 0) to.address = kLocalHost;
    if (!socket.stream) {
        if (is_broadcast(to.address) && !socket.options.broadcast) return EACCES;
        const IpAddress source = source_for(to.address);
        if (leaves_loopback(socket, to.address)) return EINVAL;
        if (source == 0) return ENETUNREACH;
        if (!socket.bound)
            if (const int error = bind_somewhere(socket, 0)) return error;
        if (socket.local.address == 0) socket.local.address = source;
        socket.peer = to;
        socket.connected = true;
        return 0;
    }
    if (socket.listening) return EISCONN;
    if (socket.tcp) {
        switch (socket.tcp->state()) {
        case TcpConnection::State::SynSent:
        case TcpConnection::State::SynReceived:
            return EALREADY;
        case TcpConnection::State::Closed:
            if (const int error = take_error(socket)) return error;
            // The error was asked for by SO_ERROR; Linux' connect() has its own for the end of the attempt.
            if (std::exchange(socket.connecting, false)) return ECONNABORTED;
            socket.tcp.reset();  // it may try again
            break;
        default:
            return std::exchange(socket.connecting, false) ? 0 : EISCONN;
        }
    }
    if (is_for_many(to.address)) return ENETUNREACH;
    const IpAddress source = source_for(to.address);
    if (leaves_loopback(socket, to.address)) return EINVAL;
    if (source == 0) return ENETUNREACH;
    if (to.port == 0) return ECONNREFUSED;
    if (!socket.bound)
        if (const int error = bind_somewhere(socket, 0)) return error;
    if (socket.local.address == 0) socket.local.address = source;
    const bool same = std::any_of(sockets_.begin(), sockets_.end(), [&](const auto& other) {
        const TcpConnection* tcp = other.second->tcp.get();
        return tcp != nullptr && tcp->state() != TcpConnection::State::Closed &&
               tcp->local() == socket.local && tcp->peer() == to;
    });
    if (same) return EADDRNOTAVAIL;
    socket.tcp = std::make_unique<TcpConnection>(
        socket.local, to, static_cast<std::uint32_t>(random_.next() >> 32), settings_of(socket.options));
    set_patience(socket.tcp->settings(), socket.options);
    ++counts_.connections;
    socket.connecting = true;
    socket.tcp->connect(now);
    if (!is_own(to.address) && !known_.contains(to.address)) socket.unreachable_at = now + kAsking;
    flush(socket, now);
    return EINPROGRESS;
}

void NetworkStack::disconnect(int id) {
    Socket& socket = at(id);
    if (socket.stream) return;
    socket.connected = false;
    socket.peer = {};
}

int NetworkStack::connecting(int id) {
    Socket& socket = at(id);
    if (!socket.tcp) return ENOTCONN;
    const bool closed = socket.tcp->state() == TcpConnection::State::Closed;
    if (!closed && !socket.tcp->synchronised()) return EINPROGRESS;
    socket.connecting = false;
    if (!closed) return 0;
    const int error = take_error(socket);
    return error != 0 ? error : ECONNABORTED;
}

int NetworkStack::listen(int id, int backlog) {
    Socket& socket = at(id);
    if (!socket.stream) return EOPNOTSUPP;
    if (socket.tcp) return EINVAL;
    if (!socket.bound)
        if (const int error = bind_somewhere(socket, 0)) return error;
    // Sharing an address with a listener is not allowed, whatever the options.
    const bool listened = std::any_of(sockets_.begin(), sockets_.end(), [&](const auto& entry) {
        const Socket& other = *entry.second;
        return &other != &socket && other.listening && other.local.port == socket.local.port &&
               (other.local.address == 0 || socket.local.address == 0 ||
                other.local.address == socket.local.address) &&
               !(other.options.reuse_port && socket.options.reuse_port);
    });
    if (listened) return EADDRINUSE;
    socket.listening = true;
    socket.backlog = static_cast<std::size_t>(std::clamp(backlog, 0, kMostBacklog));
    return 0;
}

int NetworkStack::accept(int id) {
    Socket& listener = at(id);
    if (listener.ready.empty()) return -1;
    const int connection = listener.ready.front();
    listener.ready.pop_front();
    Socket& socket = at(connection);
    socket.open = true;
    socket.listener = -1;
    return connection;
}

int NetworkStack::take_error(Socket& socket) {
    if (socket.error != 0) return std::exchange(socket.error, 0);
    return socket.tcp ? socket.tcp->take_error() : 0;
}

int NetworkStack::send_stream(Socket& socket, std::string_view data, std::size_t& taken, Time now,
                              bool more) {
    if (!socket.tcp || socket.listening) return EPIPE;
    const bool closed = socket.tcp->state() == TcpConnection::State::Closed;
    if (!closed && !socket.tcp->synchronised()) return EAGAIN;
    if (const int error = take_error(socket)) return error;
    if (socket.write_shut || socket.tcp->write_done() || socket.tcp->state() == TcpConnection::State::Closed)
        return EPIPE;
    taken = socket.tcp->write(data, now, more);
    flush(socket, now);
    return taken == 0 && !data.empty() ? EAGAIN : 0;
}

void NetworkStack::flush(Socket& socket, Time now) {
    if (!socket.tcp) return;
    for (const TcpSegment& segment : socket.tcp->take_segments()) {
        IpPacket packet;
        packet.from = socket.tcp->local().address;
        packet.to = socket.tcp->peer().address;
        packet.protocol = protocols::kTcp;
        packet.service = static_cast<protocols::Octet>(socket.options.service);
        packet.ttl = static_cast<std::uint8_t>(std::max(socket.options.time_to_live, 1));
        packet.payload = protocols::encode_tcp(segment, packet.from, packet.to);
        emit(std::move(packet), now);
    }
}

void NetworkStack::deliver(const TcpSegment& segment, const IpPacket& packet, Time now) {
    const Endpoint here{packet.to, segment.to_port}, there{packet.from, segment.from_port};
    std::vector<Socket*> listeners;  // of the address, or if there is none of any
    Socket* waiting = nullptr;       // in TimeWait
    for (const auto& [id, socket] : sockets_) {
        const TcpConnection* tcp = socket->tcp.get();
        if (tcp != nullptr && tcp->local() == here && tcp->peer() == there &&
            tcp->state() != TcpConnection::State::Closed) {
            const bool again = tcp->state() == TcpConnection::State::TimeWait &&
                               (segment.flags & (protocols::kSyn | protocols::kAck)) == protocols::kSyn;
            if (!again) return arrived(*socket, segment, now);
            waiting = socket.get();
        }
        const bool hears = socket->listening && socket->local.port == here.port &&
                           (socket->local.address == 0 || socket->local.address == here.address);
        if (!hears) continue;
        if (!listeners.empty() && socket->local.address != listeners.front()->local.address) {
            if (socket->local.address == 0) continue;
            listeners.clear();
        }
        listeners.push_back(socket.get());
    }
    constexpr auto kKinds = protocols::kSyn | protocols::kAck | protocols::kRst;
    if (listeners.empty() || (segment.flags & kKinds) != protocols::kSyn) return refuse(segment, packet, now);
    if (waiting != nullptr) waiting->tcp->fail(0);
    opened_by(*listeners[share_of(here, there, listeners.size())], segment, packet, now);
}

void NetworkStack::arrived(Socket& socket, const TcpSegment& segment, Time now) {
    const bool was_open = socket.tcp->synchronised();
    socket.unreachable_at = kNever;
    socket.tcp->receive(segment, now);
    flush(socket, now);
    if (socket.listener < 0) return forget_closed();
    const auto listener = sockets_.find(socket.listener);
    if (socket.tcp->state() == TcpConnection::State::Closed) {
        if (listener != sockets_.end() && !was_open) {
            socket.listener = -1;
            return forget_closed();
        }
        return;  // it is accepted, and found to be over
    }
    if (was_open || !socket.tcp->synchronised() || listener == sockets_.end()) return;
    listener->second->ready.push_back(socket.id);
    ++listener->second->activity;
}

/// A full backlog drops the SYN; it will be sent again.
void NetworkStack::opened_by(Socket& listener, const TcpSegment& syn, const IpPacket& packet, Time now) {
    const auto waiting = std::count_if(sockets_.begin(), sockets_.end(), [&](const auto& other) {
        return other.second->listener == listener.id;
    });
    if (static_cast<std::size_t>(waiting) > listener.backlog) return;
    Socket& socket = add(SocketKind::Stream);
    socket.open = false;
    socket.listener = listener.id;
    socket.options = listener.options;
    socket.local = {packet.to, syn.to_port};
    socket.bound = true;
    socket.tcp = std::make_unique<TcpConnection>(socket.local, Endpoint{packet.from, syn.from_port},
                                                 static_cast<std::uint32_t>(random_.next() >> 32),
                                                 settings_of(socket.options));
    set_patience(socket.tcp->settings(), socket.options);
    ++counts_.connections;
    socket.tcp->answer(syn, now);
    flush(socket, now);
}

/// To a port that nobody has (RFC 9293, 3.10.7.1).
void NetworkStack::refuse(const TcpSegment& segment, const IpPacket& packet, Time now) {
    if ((segment.flags & protocols::kRst) != 0) return;
    ++counts_.no_port;
    IpPacket answer;
    answer.from = packet.to;
    answer.to = packet.from;
    answer.protocol = protocols::kTcp;
    answer.payload = protocols::encode_tcp(protocols::reset_for(segment), answer.from, answer.to);
    emit(std::move(answer), now);
}

void NetworkStack::close_stream(Socket& socket, Time now) {
    if (socket.listening) {
        socket.listening = false;
        socket.ready.clear();
        for (const auto& [id, other] : sockets_) {
            if (other->listener != socket.id) continue;
            other->listener = -1;
            other->tcp->abort(now);
            flush(*other, now);
        }
        return;
    }
    if (!socket.tcp) return;
    socket.unreachable_at = kNever;
    if (socket.options.linger && socket.options.linger_s == 0)
        socket.tcp->abort(now);
    else
        socket.tcp->close(now);
    flush(socket, now);
}

}  // namespace puckloop::linuxboard
