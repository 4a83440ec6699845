#pragma once
// A socket as the kernel keeps it.

#include "linuxboard/shim/network/tcp_connection.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <set>
#include <string>

namespace puckloop::linuxboard {

/// What setsockopt() sets; most is stored and read back.
struct SocketOptions {
    bool no_delay = false, reuse_address = false, reuse_port = false, broadcast = false, keep_alive = false;
    bool linger = false;
    int linger_s = 0;
    cosim::Time receive_timeout = 0, send_timeout = 0;    ///< 0: never
    int receive_buffer = 212'992, send_buffer = 212'992;  ///< as getsockopt() gives them; rmem_default
    int keep_idle = 7200, keep_interval = 75, keep_count = 9;
    int time_to_live = 64, service = 0, priority = 0;
    int group_time_to_live = 1;
    bool group_loop = true;
    int user_timeout = 0;  ///< ms
    int syn_count = 6, defer_accept = 0, low_water = 1;
    bool quick_acknowledgement = true, cork = false;
    bool all_groups = true;  ///< IP_MULTICAST_ALL
    // What recvmsg() gives beside a datagram: IP_PKTINFO, IP_RECVTTL, IP_RECVTOS, SO_TIMESTAMP, ..NS.
    bool packet_info = false, with_time_to_live = false, with_service = false;
    bool time_stamp = false, fine_time_stamp = false;
    // Stored and read back, without effect.
    bool direct = false, oob_inline = false, overflow = false, no_check = false, free_bind = false,
         late_port = false, receive_errors = false;
    int path_mtu_discovery = 1, linger_finished = 60, window_clamp = 0, fast_open = 0, unsent_low_water = 0;
    int most_segment = 0;  ///< TCP_MAXSEG; 0: by the interface
    std::string device{};  ///< SO_BINDTODEVICE
};

enum class SocketKind : std::uint8_t { Datagram, Stream, Echo, Netlink };

struct Socket {
    /// What a datagram takes of the buffer beside its data, as of Linux (sk_buff).
    static constexpr std::size_t kDatagramCost = 768;
    struct Datagram {
        Endpoint from;
        std::string data;
        cosim::Time time = 0;
        protocols::IpAddress to = 0;
        protocols::Octet time_to_live = 0, service = 0;
    };

    int id = 0;
    bool stream = false;
    bool echo = false;     ///< of ICMP echoes: SOCK_DGRAM with IPPROTO_ICMP; the port is the identifier
    bool netlink = false;  ///< of NETLINK_ROUTE; the address is its number, the kernel's is 0
    bool open = true;      ///< a program has it
    Endpoint local{}, peer{};
    bool bound = false, connected = false;
    bool read_shut = false, write_shut = false;
    int error = 0;  ///< SO_ERROR, where it is not the connection's
    std::uint32_t activity = 1;
    SocketOptions options{};

    // SOCK_DGRAM
    std::deque<Datagram> queue{};
    std::size_t queued = 0;  ///< octets, with what the kernel needs for each
    std::set<protocols::IpAddress> groups{};

    // SOCK_STREAM
    std::unique_ptr<TcpConnection> tcp{};
    bool listening = false;
    std::size_t backlog = 0;
    std::deque<int> ready{};  ///< connections to be accepted
    bool connecting = false;  ///< connect() was called, and nobody was given its end yet
    int listener = -1;        ///< of one that is not accepted yet
    cosim::Time unreachable_at = cosim::kNever;
};

}  // namespace puckloop::linuxboard
