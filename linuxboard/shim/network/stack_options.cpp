// setsockopt() and getsockopt().

#include "linuxboard/shim/network/network_stack.h"
#include "linuxboard/shim/network/tcp_states.h"

#include <linux/netlink.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace puckloop::linuxboard {

using cosim::Time;

namespace {

constexpr int kSmallestReceive = 2304, kSmallestSend = 4608;  // SOCK_MIN_RCVBUF, SOCK_MIN_SNDBUF
constexpr int kMostBuffer = 212'992;                          // rmem_max, wmem_max

template <typename T>
bool read_value(std::string_view bytes, T& value) {
    if (bytes.size() < sizeof value) return false;
    std::memcpy(&value, bytes.data(), sizeof value);
    return true;
}

template <typename T>
std::string bytes_as(const T& value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    return bytes;
}

/// Flags of which the value is 0 or 1.
bool* flag_of(SocketOptions& options, int level, int name) {
    if (level == SOL_SOCKET) {
        switch (name) {
        case SO_REUSEADDR:
            return &options.reuse_address;
        case SO_REUSEPORT:
            return &options.reuse_port;
        case SO_BROADCAST:
            return &options.broadcast;
        case SO_KEEPALIVE:
            return &options.keep_alive;
        case SO_DONTROUTE:
            return &options.direct;
        case SO_OOBINLINE:
            return &options.oob_inline;
        case SO_TIMESTAMP:
            return &options.time_stamp;
        case SO_TIMESTAMPNS:
            return &options.fine_time_stamp;
        case SO_RXQ_OVFL:
            return &options.overflow;
        case SO_NO_CHECK:
            return &options.no_check;
        default:
            return nullptr;
        }
    }
    if (level == IPPROTO_TCP && name == TCP_NODELAY) return &options.no_delay;
    if (level == IPPROTO_TCP && name == TCP_QUICKACK) return &options.quick_acknowledgement;
    if (level == IPPROTO_TCP && name == TCP_CORK) return &options.cork;
    if (level != IPPROTO_IP) return nullptr;
    switch (name) {
    case IP_MULTICAST_LOOP:
        return &options.group_loop;
    case IP_MULTICAST_ALL:
        return &options.all_groups;
    case IP_PKTINFO:
        return &options.packet_info;
    case IP_RECVTTL:
        return &options.with_time_to_live;
    case IP_RECVTOS:
        return &options.with_service;
    case IP_RECVERR:
        return &options.receive_errors;
    case IP_FREEBIND:
        return &options.free_bind;
    case IP_BIND_ADDRESS_NO_PORT:
        return &options.late_port;
    default:
        return nullptr;
    }
}

/// Numbers that are stored and read back, with their range.
struct Number {
    int* value = nullptr;
    int low = 0, high = INT32_MAX;
};
Number number_of(SocketOptions& options, int level, int name) {
    if (level == SOL_SOCKET && name == SO_PRIORITY) return {&options.priority, 0, 6};
    if (level == SOL_SOCKET && name == SO_RCVLOWAT) return {&options.low_water, 1};
    if (level == IPPROTO_IP) {
        if (name == IP_TTL) return {&options.time_to_live, 1, 255};
        if (name == IP_TOS) return {&options.service, 0, 255};
        if (name == IP_MULTICAST_TTL) return {&options.group_time_to_live, 0, 255};
        if (name == IP_MTU_DISCOVER) return {&options.path_mtu_discovery, 0, 5};
        return {};
    }
    if (level != IPPROTO_TCP) return {};
    switch (name) {
    case TCP_KEEPIDLE:
        return {&options.keep_idle, 1, 32'767};
    case TCP_KEEPINTVL:
        return {&options.keep_interval, 1, 32'767};
    case TCP_KEEPCNT:
        return {&options.keep_count, 1, 127};
    case TCP_USER_TIMEOUT:
        return {&options.user_timeout};
    case TCP_DEFER_ACCEPT:
        return {&options.defer_accept};
    case TCP_SYNCNT:
        return {&options.syn_count, 1, 127};
    case TCP_LINGER2:
        return {&options.linger_finished, INT32_MIN};
    case TCP_WINDOW_CLAMP:
        return {&options.window_clamp};
    case TCP_FASTOPEN:
        return {&options.fast_open};
    case TCP_NOTSENT_LOWAT:
        return {&options.unsent_low_water, INT32_MIN};
    default:
        return {};
    }
}

int set_timeout(Time& timeout, std::string_view value) {
    timeval time{};
    if (!read_value(value, time)) return EINVAL;
    if (time.tv_usec < 0 || time.tv_usec >= 1'000'000) return EDOM;
    constexpr long kLongest = 1'000'000;  // s
    timeout = time.tv_sec < 0
                  ? 0
                  : std::min(time.tv_sec, kLongest) * cosim::kSecond + time.tv_usec * cosim::kMicrosecond;
    return 0;
}

/// As far as there is something to say; states as the kernel numbers them.
tcp_info info_of(const TcpConnection& tcp) {
    const auto microseconds = [](Time time) {
        return static_cast<std::uint32_t>(time / cosim::kMicrosecond);
    };
    const TcpConnection::Figures figures = tcp.figures();
    const std::uint32_t segment = std::max(figures.segment, 1u);
    tcp_info info{};
    info.tcpi_state = static_cast<std::uint8_t>(number_of(tcp.state()));
    info.tcpi_rto = microseconds(figures.timeout);
    info.tcpi_rtt = microseconds(figures.round_trip);
    info.tcpi_rttvar = microseconds(figures.variation);
    info.tcpi_snd_mss = info.tcpi_rcv_mss = info.tcpi_advmss = figures.segment;
    info.tcpi_pmtu = protocols::kMtu;
    info.tcpi_snd_cwnd = figures.congestion / segment;
    info.tcpi_snd_ssthresh = figures.threshold / segment;
    info.tcpi_unacked = static_cast<std::uint32_t>((tcp.unacknowledged() - tcp.unsent()) / segment);
    info.tcpi_total_retrans = static_cast<std::uint32_t>(tcp.counts().retransmitted);
    return info;
}

timeval as_timeval(Time time) {
    return {time / cosim::kSecond, time % cosim::kSecond / cosim::kMicrosecond};
}

}  // namespace

void NetworkStack::watch_peer(Socket& socket, Time now) {
    if (!socket.tcp) return;
    set_patience(socket.tcp->settings(), socket.options);
    socket.tcp->watch_peer(now);
}

int NetworkStack::set_option(int id, int level, int name, std::string_view value, Time now) {
    Socket& socket = at(id);
    SocketOptions& options = socket.options;
    if (level == SOL_NETLINK && socket.netlink) return 0;  // what they ask for beside answers never comes
    if (socket.netlink && level != SOL_SOCKET) return ENOPROTOOPT;
    if (level == IPPROTO_TCP && !socket.stream) return ENOPROTOOPT;
    if (level == IPPROTO_IP && (name == IP_ADD_MEMBERSHIP || name == IP_DROP_MEMBERSHIP)) {
        ip_mreq wish{};
        if (!read_value(value, wish)) return EINVAL;
        const protocols::IpAddress group = ntohl(wish.imr_multiaddr.s_addr),
                                   own = ntohl(wish.imr_interface.s_addr);
        if (!is_group(group) || socket.stream) return EINVAL;
        ip_mreqn longer{};  // may name the interface by number: 1 lo, 2 wlan0
        const bool by_number = read_value(value, longer) && longer.imr_ifindex != 0;
        if (by_number ? longer.imr_ifindex > 2 : own != 0 && !is_own(own)) return ENODEV;
        if (name == IP_ADD_MEMBERSHIP) return socket.groups.insert(group).second ? 0 : EADDRINUSE;
        return socket.groups.erase(group) != 0 ? 0 : EADDRNOTAVAIL;
    }
    if (level == SOL_SOCKET && name == SO_BINDTODEVICE) {
        const std::string device(value.substr(0, value.find('\0')));
        if (!device.empty() && device != "lo" && device != "wlan0") return ENODEV;
        options.device = device;
        return 0;
    }
    if (level == IPPROTO_TCP && name == TCP_CONGESTION)
        return value.substr(0, value.find('\0')) == "reno" ? 0 : ENOENT;
    if (level == IPPROTO_IP && name == IP_MULTICAST_IF) {
        in_addr address{};
        if (value.size() >= sizeof(ip_mreqn)) {
            ip_mreqn wish{};
            read_value(value, wish);
            address = wish.imr_address;
        } else if (!read_value(value, address)) {
            return EINVAL;
        }
        return address.s_addr == 0 || is_own(ntohl(address.s_addr)) ? 0 : EADDRNOTAVAIL;
    }
    if (level == SOL_SOCKET && name == SO_LINGER) {
        ::linger wish{};
        if (!read_value(value, wish)) return EINVAL;
        options.linger = wish.l_onoff != 0;
        options.linger_s = wish.l_linger;
        return 0;
    }
    if (level == SOL_SOCKET && name == SO_RCVTIMEO) return set_timeout(options.receive_timeout, value);
    if (level == SOL_SOCKET && name == SO_SNDTIMEO) return set_timeout(options.send_timeout, value);
    int number = 0;
    const bool is_octet = level == IPPROTO_IP && value.size() == 1;
    if (is_octet)
        number = static_cast<unsigned char>(value[0]);
    else if (!read_value(value, number))
        return EINVAL;
    if (level == SOL_SOCKET && name == SO_RCVBUF) {
        options.receive_buffer = std::max(2 * std::clamp(number, 0, kMostBuffer), kSmallestReceive);
        return 0;
    }
    if (level == SOL_SOCKET && name == SO_SNDBUF) {
        options.send_buffer = std::max(2 * std::clamp(number, 0, kMostBuffer), kSmallestSend);
        if (socket.tcp)
            socket.tcp->settings().send_buffer = static_cast<std::size_t>(options.send_buffer / 2);
        return 0;
    }
    if (bool* flag = flag_of(options, level, name)) {
        *flag = number != 0;
        if (flag == &options.no_delay && socket.tcp) {
            socket.tcp->set_no_delay(*flag, now);
            flush(socket, now);
        }
        if (flag == &options.cork && socket.tcp) {
            socket.tcp->set_cork(*flag, now);
            flush(socket, now);
        }
        if (flag == &options.keep_alive) watch_peer(socket, now);
        return 0;
    }
    if (level == IPPROTO_IP && name == IP_TTL && number == -1) number = 64;
    if (level == IPPROTO_IP && (name == IP_RECVOPTS || name == IP_RETOPTS)) return 0;  // there are none
    if (level == SOL_SOCKET && (name == SO_MARK || name == SO_SNDBUFFORCE || name == SO_RCVBUFFORCE))
        return EPERM;  // as for a user without rights
    if (level == IPPROTO_TCP && name == TCP_MAXSEG) {
        constexpr int kLeast = 88, kMost = 32'767;  // TCP_MIN_MSS, MAX_TCP_WINDOW
        if (number != 0 && (number < kLeast || number > kMost)) return EINVAL;
        options.most_segment = number;
        return 0;
    }
    const Number stored = number_of(options, level, name);
    if (stored.value == nullptr) return ENOPROTOOPT;
    if (number < stored.low || number > stored.high)
        return name == SO_PRIORITY && level == SOL_SOCKET ? EPERM : EINVAL;
    if (level == IPPROTO_TCP && name == TCP_WINDOW_CLAMP && number != 0)
        number = std::max(number, kSmallestReceive / 2);
    *stored.value = number;
    if (level == IPPROTO_TCP) watch_peer(socket, now);
    return 0;
}

int NetworkStack::get_option(int id, int level, int name, std::string& value) {
    Socket& socket = at(id);
    SocketOptions& options = socket.options;
    const auto give = [&](const auto& what) {
        value = bytes_as(what);
        return 0;
    };
    if (static_cast<std::uint32_t>(level) == wire::kNetworkTables) {
        value = table(static_cast<NetworkTable>(name)).substr(0, wire::kMaximumData);
        return 0;
    }
    if (socket.netlink && level != SOL_SOCKET) return ENOPROTOOPT;
    if (level == IPPROTO_TCP && !socket.stream) return ENOPROTOOPT;
    if (const bool* flag = flag_of(options, level, name)) return give(int{*flag ? 1 : 0});
    if (const Number stored = number_of(options, level, name); stored.value != nullptr)
        return give(*stored.value);
    if (level == IPPROTO_TCP && name == TCP_MAXSEG) {
        constexpr int kBefore = 536;  // TCP_MSS_DEFAULT
        if (socket.tcp) return give(static_cast<int>(socket.tcp->figures().segment));
        return give(options.most_segment != 0 ? options.most_segment : kBefore);
    }
    if (level == IPPROTO_TCP && name == TCP_INFO) return give(socket.tcp ? info_of(*socket.tcp) : tcp_info{});
    if (level == IPPROTO_TCP && name == TCP_CONGESTION) {
        constexpr std::size_t kLongestName = 16;  // TCP_CA_NAME_MAX
        value = "reno";
        value.resize(kLongestName);
        return 0;
    }
    if (level == IPPROTO_IP && name == IP_MULTICAST_IF) return give(in_addr{});
    if (level == IPPROTO_IP && name == IP_MTU) {
        if (!socket.connected && !socket.tcp) return ENOTCONN;
        return give(static_cast<int>(protocols::kMtu));
    }
    if (level == SOL_SOCKET && name == SO_BINDTODEVICE) {
        value = options.device;
        if (!value.empty()) value += '\0';
        return 0;
    }
    if (level != SOL_SOCKET) return ENOPROTOOPT;
    switch (name) {
    case SO_ERROR:
        return give(take_error(socket));
    case SO_TYPE:
        return give(int{socket.stream ? SOCK_STREAM : socket.netlink ? SOCK_RAW : SOCK_DGRAM});
    case SO_DOMAIN:
        return give(int{socket.netlink ? AF_NETLINK : AF_INET});
    case SO_PROTOCOL:
        return give(int{socket.netlink  ? NETLINK_ROUTE
                        : socket.stream ? IPPROTO_TCP
                        : socket.echo   ? IPPROTO_ICMP
                                        : IPPROTO_UDP});
    case SO_ACCEPTCONN:
        return give(int{socket.listening ? 1 : 0});
    case SO_RCVBUF:
        return give(options.receive_buffer);
    case SO_SNDBUF:
        return give(options.send_buffer);
    case SO_SNDLOWAT:
        return give(int{1});
    case SO_INCOMING_CPU:
        return give(int{-1});  // not known
    case SO_MARK:
    case SO_BUSY_POLL:
        return give(int{0});
    case SO_LINGER:
        return give(::linger{options.linger ? 1 : 0, options.linger_s});
    case SO_RCVTIMEO:
        return give(as_timeval(options.receive_timeout));
    case SO_SNDTIMEO:
        return give(as_timeval(options.send_timeout));
    default:
        return ENOPROTOOPT;
    }
}

}  // namespace puckloop::linuxboard
