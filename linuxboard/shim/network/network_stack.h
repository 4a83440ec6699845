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
#include "linuxboard/shim/network/network_spec.h"
#include "linuxboard/shim/network/socket.h"

#include <cerrno>
#include <cstdint>
#include <deque>
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

/// A packet for the network, handed over at `time`.
struct PacketOut {
    cosim::Time time = 0;
    cosim::Octets octets;
};

class NetworkStack {
  public:
    NetworkStack(const NetworkSpec& spec, RandomStream random);

    // Calls: 0, or errno. Sockets have numbers; each call names one that is open.
    int open(bool stream);
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
    int send(int id, std::optional<Endpoint> to, std::string_view data, std::size_t& taken, cosim::Time now);
    /// The next call that takes one fails with it.
    void keep_error(int id, int error) {
        if (error != EPIPE) at(id).error = error;
    }
    struct Received {
        std::string data;
        Endpoint from{};
        std::size_t size = 0;  ///< of the datagram
    };
    /// EAGAIN: nothing is there. At the end of a stream the data is empty.
    int receive(int id, std::size_t most, bool peek, Received& received, cosim::Time now);
    int shutdown(int id, int how, cosim::Time now);
    int name_of(int id, bool peer, Endpoint& name) const;
    int set_option(int id, int level, int name, std::string_view value, cosim::Time now);
    int get_option(int id, int level, int name, std::string& value);
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

  private:
    using IpPacket = protocols::IpPacket;

    Socket& at(int id) { return *sockets_.at(id); }
    const Socket& at(int id) const { return *sockets_.at(id); }
    Socket& add(bool stream);
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

    // stack_datagrams.cpp
    int send_datagram(Socket& socket, Endpoint to, std::string_view data, cosim::Time now);
    void deliver(const protocols::UdpDatagram& datagram, const IpPacket& packet, cosim::Time now);
    static void put(Socket& socket, Endpoint from, const std::string& data, NetworkCounts& counts);
    void unreachable(const protocols::IcmpMessage& message);

    // stack_streams.cpp
    int send_stream(Socket& socket, std::string_view data, std::size_t& taken, cosim::Time now);
    void deliver(const protocols::TcpSegment& segment, const IpPacket& packet, cosim::Time now);
    void arrived(Socket& socket, const protocols::TcpSegment& segment, cosim::Time now);
    void opened_by(Socket& listener, const protocols::TcpSegment& syn, const IpPacket& packet,
                   cosim::Time now);
    void refuse(const protocols::TcpSegment& segment, const IpPacket& packet, cosim::Time now);
    void flush(Socket& socket, cosim::Time now);
    void close_stream(Socket& socket, cosim::Time now);
    static int take_error(Socket& socket);

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
    TcpCounts ended_;  ///< of connections that are no more
};

inline constexpr protocols::IpAddress kLocalHost = 0x7f000001;
/// A packet from the board to itself arrives so much later.
inline constexpr cosim::Time kLoopback = 10 * cosim::kMicrosecond;

}  // namespace puckloop::linuxboard
