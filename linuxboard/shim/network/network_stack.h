#pragma once
// The network part of the emulated kernel: sockets, and IPv4 with UDP, TCP and what of ICMP they need.
// Packets come in and go out with times; a packet for the board itself takes a moment (kLoopback).
//
// Deviations: 1. One interface beside `lo`, no gateway: what is not in the network is unreachable. 2. Whoever
// has an address is known, so nobody asks for it (ARP); an address that nobody has is unreachable after the
// time that asking takes. 3. Groups are joined without a word on the network (IGMP), which carries multicasts
// to everybody. 4. The kernel itself needs no time.

#include "base/random.h"
#include "cosim/core/message.h"
#include "linuxboard/shim/network/name_server.h"
#include "linuxboard/shim/network/network_spec.h"
#include "linuxboard/shim/network/socket.h"
#include "linuxboard/shim/wire/wire.h"

#include <cerrno>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace puckloop::linuxboard {

/// Counted for the report.
struct NetworkCounts {
    std::uint64_t packets_sent = 0, packets_received = 0;
    std::uint64_t datagrams_sent = 0, datagrams_received = 0;
    std::uint64_t datagrams_dropped = 0;  ///< no room in a socket's buffer
    std::uint64_t no_port = 0;            ///< for a port that nobody has
    std::uint64_t unreachable = 0;        ///< sent to an address that nobody has
    std::uint64_t damaged = 0;            ///< with a wrong checksum
    std::uint64_t connections = 0;        ///< opened, by either side
};

/// Of lo and of wlan0.
struct InterfaceCounts {
    std::uint64_t packets_sent = 0, packets_received = 0, octets_sent = 0, octets_received = 0;
};

using wire::NetworkTable;

/// A packet for the network, handed over at `time`.
struct PacketOut {
    cosim::Time time = 0;
    cosim::Octets octets;
};

class NetworkStack {
  public:
    NetworkStack(const NetworkSpec& spec, RandomStream random);

    // Calls: 0, or errno. Sockets have numbers; each call names one that is open.
    int open(SocketKind kind);
    int open(bool stream) { return open(stream ? SocketKind::Stream : SocketKind::Datagram); }
    void close(int id, cosim::Time now);
    int bind(int id, Endpoint to);
    /// EINPROGRESS: begun; connecting() says what came of it.
    int connect(int id, Endpoint to, cosim::Time now);
    void disconnect(int id);
    /// EINPROGRESS: not known yet.
    int connecting(int id);
    int listen(int id, int backlog);
    /// The number of a connection, or -1: none is there.
    int accept(int id);
    bool listening(int id) const { return at(id).listening; }
    /// `taken`: octets; EAGAIN: none for now.
    int send(int id, std::optional<Endpoint> to, std::string_view data, std::size_t& taken, cosim::Time now,
             bool more = false);
    /// The next call that takes one fails with it.
    void keep_error(int id, int error) {
        if (error != EPIPE) at(id).error = error;
    }
    struct Received {
        std::string data;
        Endpoint from{};
        std::size_t size = 0;  ///< of the datagram
        // Of a datagram.
        cosim::Time time = 0;
        protocols::IpAddress to = 0;
        protocols::Octet time_to_live = 0, service = 0;
    };
    /// EAGAIN: nothing is there. At the end of a stream the data is empty.
    int receive(int id, std::size_t most, bool peek, Received& received, cosim::Time now);
    int shutdown(int id, int how, cosim::Time now);
    int name_of(int id, bool peer, Endpoint& name) const;
    int set_option(int id, int level, int name, std::string_view value, cosim::Time now);
    int get_option(int id, int level, int name, std::string& value);
    /// As the board's /proc/net has it.
    std::string table(NetworkTable which) const;
    /// As poll() has them.
    int events(int id) const;
    std::uint32_t activity(int id) const;
    std::size_t readable(int id) const;
    std::size_t unsent(int id) const;
    const SocketOptions& options(int id) const { return at(id).options; }
    bool is_stream(int id) const { return at(id).stream; }

    void receive_packet(std::span<const std::uint8_t> octets, cosim::Time now);
    void advance(cosim::Time now);
    cosim::Time next_event() const;
    std::vector<PacketOut> take_packets() { return std::exchange(out_, {}); }
    bool has_packets() const { return !out_.empty(); }
    /// All programs are gone.
    void close_all(cosim::Time now);
    bool was_used() const { return used_; }
    /// JSON: addresses, counters, TCP's sums.
    std::string report() const;
    const NetworkCounts& counts() const { return counts_; }
    /// Asked for each question to the board's resolver; true: it gets no answer.
    void set_silence(std::function<bool(cosim::Time now, std::string_view name)> silence) {
        silence_ = std::move(silence);
    }
    /// Names that the resolver was asked for and nobody has.
    const std::set<std::string>& unknown_names() const { return unknown_names_; }

  private:
    using IpPacket = protocols::IpPacket;

    /// To be changed.
    Socket& at(int id) {
        next_event_.reset();
        return *sockets_.at(id);
    }
    const Socket& at(int id) const { return *sockets_.at(id); }
    Socket& add(SocketKind kind);
    void forget_closed();

    // network_stack.cpp: packets
    bool is_own(protocols::IpAddress address) const;
    bool is_group(protocols::IpAddress address) const { return address >> 28 == 0xe; }
    bool is_broadcast(protocols::IpAddress address) const;
    bool is_for_many(protocols::IpAddress address) const {
        return is_group(address) || is_broadcast(address);
    }
    /// The address that a packet to `to` comes from; 0: there is no way.
    protocols::IpAddress source_for(protocols::IpAddress to) const;
    void emit(IpPacket packet, cosim::Time now, bool loop = true);
    void take_in(const IpPacket& packet, cosim::Time now);
    std::optional<IpPacket> reassemble(const IpPacket& fragment, cosim::Time now);

    // stack_ports.cpp
    bool is_taken(const Socket& socket, Endpoint endpoint) const;
    int bind_somewhere(Socket& socket, protocols::IpAddress address);
    bool leaves_loopback(const Socket& socket, protocols::IpAddress to) const;
    static std::size_t share_of(Endpoint here, Endpoint there, std::size_t count);

    // stack_datagrams.cpp
    int send_datagram(Socket& socket, Endpoint to, std::string_view data, cosim::Time now);
    void deliver(const protocols::UdpDatagram& datagram, const IpPacket& packet, cosim::Time now);
    static void put(Socket& socket, Socket::Datagram datagram, NetworkCounts& counts);
    void unreachable(const protocols::IcmpMessage& message);
    void answer_question(const protocols::UdpDatagram& question, protocols::IpAddress from, cosim::Time now);

    // stack_echoes.cpp
    int send_echo(Socket& socket, Endpoint to, std::string_view data, cosim::Time now);
    void take_in(const protocols::IcmpMessage& message, const IpPacket& packet, cosim::Time now);

    // stack_netlink.cpp
    int send_netlink(Socket& socket, std::string_view data, cosim::Time now);
    static void bind_netlink(Socket& socket, std::uint32_t number);
    void answer_netlink(Socket& socket, std::string_view request, cosim::Time now);
    static void put_answer(Socket& socket, std::string message, cosim::Time now);

    // stack_streams.cpp
    int send_stream(Socket& socket, std::string_view data, std::size_t& taken, cosim::Time now, bool more);
    void deliver(const protocols::TcpSegment& segment, const IpPacket& packet, cosim::Time now);
    void arrived(Socket& socket, const protocols::TcpSegment& segment, cosim::Time now);
    void opened_by(Socket& listener, const protocols::TcpSegment& syn, const IpPacket& packet,
                   cosim::Time now);
    void refuse(const protocols::TcpSegment& segment, const IpPacket& packet, cosim::Time now);
    void flush(Socket& socket, cosim::Time now);
    void close_stream(Socket& socket, cosim::Time now);
    static int take_error(Socket& socket);
    /// Of the options, what concerns how long a connection waits for its peer.
    static void set_patience(TcpConnection::Settings& settings, const SocketOptions& options);
    static void watch_peer(Socket& socket, cosim::Time now);

    struct Looped {
        cosim::Time time = 0;
        IpPacket packet;
    };
    struct Fragments {
        cosim::Time since = 0;
        std::map<std::uint16_t, std::vector<std::uint8_t>> parts;
        std::optional<std::size_t> size;
    };

    NetworkPlace place_;
    std::set<protocols::IpAddress> known_;
    NameServer names_;
    std::function<bool(cosim::Time, std::string_view)> silence_;
    std::set<std::string> unknown_names_;
    RandomStream random_;
    std::map<int, std::unique_ptr<Socket>> sockets_;
    int next_id_ = 0;
    std::uint16_t next_port_ = 0;
    std::uint16_t next_packet_ = 1;
    std::deque<Looped> looped_;
    std::map<std::tuple<protocols::IpAddress, std::uint16_t, std::uint8_t>, Fragments> fragments_;
    std::vector<PacketOut> out_;
    bool used_ = false;
    NetworkCounts counts_;
    InterfaceCounts loopback_, wireless_;
    mutable std::optional<cosim::Time> next_event_;  ///< nothing: something has happened since
    TcpCounts ended_;                                ///< of connections that are no more
};

inline constexpr protocols::IpAddress kLocalHost = 0x7f000001;
/// A packet from the board to itself arrives so much later.
inline constexpr cosim::Time kLoopback = cosim::kMicrosecond;

}  // namespace puckloop::linuxboard
