// NETLINK_ROUTE: what tools such as `ip` ask the kernel about interfaces, addresses and ways (rtnetlink(7)).
//
// Deviations: 1. Nothing ever changes, so members of groups hear nothing; changes are refused as for a user
// without rights. 2. Of filters (NETLINK_GET_STRICT_CHK) the interface's number and name count. 3. The tables
// of neighbours and rules are empty.

#include "linuxboard/shim/network/network_stack.h"
#include "linuxboard/shim/wire/interfaces.h"

#include <linux/if_addr.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if_arp.h>
#include <netinet/in.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace puckloop::linuxboard {

using cosim::Time;
using wire::Interface;

namespace {

constexpr std::size_t kMostRequest = 65'536;
constexpr std::uint8_t kUp = 6;          // IF_OPER_UP, RFC 2863
constexpr unsigned kLowerUp = 1u << 16;  // IFF_LOWER_UP, of linux/if.h

/// One message, or several in a row.
class Messages {
  public:
    Messages(const nlmsghdr& request, std::uint32_t receiver) : request_(request), receiver_(receiver) {}

    template <typename Body>
    void begin(std::uint16_t type, std::uint16_t flags, const Body& body) {
        end();
        nlmsghdr head{};
        head.nlmsg_type = type;
        head.nlmsg_flags = flags;
        head.nlmsg_seq = request_.nlmsg_seq;
        head.nlmsg_pid = receiver_;
        begin_ = text_.size();
        put(&head, sizeof head);
        put(&body, sizeof body);
        fill_up();
    }
    void attribute(std::uint16_t type, const void* data, std::size_t size) {
        const rtattr head{static_cast<unsigned short>(RTA_LENGTH(size)), type};
        put(&head, sizeof head);
        put(data, size);
        fill_up();
    }
    template <typename Value>
    void attribute(std::uint16_t type, const Value& value) {
        attribute(type, &value, sizeof value);
    }
    void attribute(std::uint16_t type, const char* text) { attribute(type, text, std::strlen(text) + 1); }
    void raw(std::string_view data) { put(data.data(), data.size()); }
    std::string take() {
        end();
        begin_ = std::string::npos;
        return std::exchange(text_, {});
    }
    bool empty() const { return text_.empty(); }

  private:
    void put(const void* data, std::size_t size) { text_.append(static_cast<const char*>(data), size); }
    void fill_up() { text_.resize((text_.size() + NLMSG_ALIGNTO - 1) / NLMSG_ALIGNTO * NLMSG_ALIGNTO); }
    /// The length of the last message is known.
    void end() {
        if (begin_ == std::string::npos) return;
        const auto size = static_cast<std::uint32_t>(text_.size() - begin_);
        std::memcpy(text_.data() + begin_ + offsetof(nlmsghdr, nlmsg_len), &size, sizeof size);
        fill_up();
    }

    nlmsghdr request_;
    std::uint32_t receiver_;
    std::string text_;
    std::size_t begin_ = std::string::npos;
};

/// What a request asks for: the beginning of its body, and attributes.
template <typename Body>
Body body_of(std::string_view request) {
    Body body{};
    if (request.size() > NLMSG_HDRLEN)
        std::memcpy(&body, request.data() + NLMSG_HDRLEN,
                    std::min(sizeof body, request.size() - NLMSG_HDRLEN));
    return body;
}
std::string_view attribute_of(std::string_view request, std::size_t body, std::uint16_t type) {
    std::size_t at = NLMSG_HDRLEN + NLMSG_ALIGN(body);
    rtattr head{};
    while (at + sizeof head <= request.size()) {
        std::memcpy(&head, request.data() + at, sizeof head);
        if (head.rta_len < sizeof head || at + head.rta_len > request.size()) break;
        if (head.rta_type == type) return request.substr(at + sizeof head, head.rta_len - sizeof head);
        at += RTA_ALIGN(head.rta_len);
    }
    return {};
}

std::string_view without_zero(std::string_view name) {
    return name.substr(0, name.find('\0'));
}

bool is_asked_for(const Interface& one, int index, std::string_view name) {
    return (index == 0 || index == one.index) && (name.empty() || name == one.name);
}

rtnl_link_stats64 statistics_of(const InterfaceCounts& counts) {
    rtnl_link_stats64 all{};
    all.rx_packets = counts.packets_received;
    all.tx_packets = counts.packets_sent;
    all.rx_bytes = counts.octets_received;
    all.tx_bytes = counts.octets_sent;
    return all;
}

void add_link(Messages& out, const Interface& one, std::uint32_t address, const InterfaceCounts& counts,
              std::uint16_t flags) {
    ifinfomsg body{};
    body.ifi_family = AF_UNSPEC;
    body.ifi_type = one.is_loopback() ? ARPHRD_LOOPBACK : ARPHRD_ETHER;
    body.ifi_index = one.index;
    body.ifi_flags = one.flags | kLowerUp;
    out.begin(RTM_NEWLINK, flags, body);
    out.attribute(IFLA_IFNAME, one.name);
    out.attribute(IFLA_TXQLEN, wire::kQueueLength);
    out.attribute(IFLA_OPERSTATE, one.is_loopback() ? std::uint8_t{0} : kUp);
    out.attribute(IFLA_LINKMODE, std::uint8_t{0});
    out.attribute(IFLA_MTU, one.mtu);
    out.attribute(IFLA_GROUP, 0);
    out.attribute(IFLA_CARRIER, std::uint8_t{1});
    out.attribute(IFLA_QDISC, one.is_loopback() ? "noqueue" : "pfifo_fast");
    std::array<unsigned char, 6> hardware{}, all{};
    if (!one.is_loopback()) {
        hardware = wire::hardware_address(address);
        all.fill(0xff);
    }
    out.attribute(IFLA_ADDRESS, hardware);
    out.attribute(IFLA_BROADCAST, all);
    out.attribute(IFLA_STATS64, statistics_of(counts));
}

void add_address(Messages& out, const Interface& one, std::uint32_t own, int prefix, std::uint16_t flags) {
    const std::uint32_t address = one.address(own), everybody = address | ~one.mask(prefix);
    ifaddrmsg body{};
    body.ifa_family = AF_INET;
    body.ifa_prefixlen = static_cast<unsigned char>(one.prefix(prefix));
    body.ifa_flags = IFA_F_PERMANENT;
    body.ifa_scope = one.is_loopback() ? RT_SCOPE_HOST : RT_SCOPE_UNIVERSE;
    body.ifa_index = static_cast<unsigned>(one.index);
    out.begin(RTM_NEWADDR, flags, body);
    out.attribute(IFA_ADDRESS, htonl(address));
    out.attribute(IFA_LOCAL, htonl(address));
    if (!one.is_loopback()) out.attribute(IFA_BROADCAST, htonl(everybody));
    out.attribute(IFA_LABEL, one.name);
    out.attribute(IFA_FLAGS, std::uint32_t{IFA_F_PERMANENT});
    constexpr std::uint32_t kForEver = 0xffffffff;
    out.attribute(IFA_CACHEINFO, ifa_cacheinfo{kForEver, kForEver, 0, 0});
}

/// To `to`, or to the network as a whole.
void add_way(Messages& out, std::uint32_t to, int bits, const Interface& by, std::uint32_t source,
             std::uint16_t flags) {
    rtmsg body{};
    body.rtm_family = AF_INET;
    body.rtm_dst_len = static_cast<unsigned char>(bits);
    body.rtm_table = by.is_loopback() ? RT_TABLE_LOCAL : RT_TABLE_MAIN;
    body.rtm_protocol = RTPROT_KERNEL;
    body.rtm_scope = RT_SCOPE_LINK;
    body.rtm_type = by.is_loopback() ? RTN_LOCAL : RTN_UNICAST;
    out.begin(RTM_NEWROUTE, flags, body);
    out.attribute(RTA_TABLE, std::uint32_t{body.rtm_table});
    out.attribute(RTA_DST, htonl(to));
    out.attribute(RTA_PREFSRC, htonl(source));
    out.attribute(RTA_OIF, std::uint32_t(by.index));
}

std::uint32_t address_in(std::string_view octets) {
    std::uint32_t address = 0;
    if (octets.size() >= sizeof address) std::memcpy(&address, octets.data(), sizeof address);
    return ntohl(address);
}

}  // namespace

/// Each request in `data` gets its answer at once.
int NetworkStack::send_netlink(Socket& socket, std::string_view data, Time now) {
    if (data.size() > kMostRequest) return EMSGSIZE;
    if (!socket.bound) bind_netlink(socket, 0);
    nlmsghdr head{};
    while (data.size() >= sizeof head) {
        std::memcpy(&head, data.data(), sizeof head);
        if (head.nlmsg_len < sizeof head || head.nlmsg_len > data.size()) break;
        if (head.nlmsg_type >= NLMSG_MIN_TYPE && (head.nlmsg_flags & NLM_F_REQUEST) != 0)
            answer_netlink(socket, data.substr(0, head.nlmsg_len), now);
        data.remove_prefix(std::min<std::size_t>(NLMSG_ALIGN(head.nlmsg_len), data.size()));
    }
    return 0;
}

void NetworkStack::bind_netlink(Socket& socket, std::uint32_t number) {
    // Linux takes the process's number for its first socket, and others for the next.
    constexpr std::uint32_t kFirst = 4096;
    socket.local = {number != 0 ? number : kFirst + static_cast<std::uint32_t>(socket.id), 0};
    socket.bound = true;
}

void NetworkStack::answer_netlink(Socket& socket, std::string_view request, Time now) {
    nlmsghdr head{};
    std::memcpy(&head, request.data(), sizeof head);
    const bool all = (head.nlmsg_flags & NLM_F_DUMP) == NLM_F_DUMP;
    const std::uint16_t flags = all ? NLM_F_MULTI : 0;
    Messages out(head, socket.local.address);
    int error = 0;
    switch (head.nlmsg_type) {
    case RTM_GETLINK: {
        const auto wish = body_of<ifinfomsg>(request);
        const std::string_view name = without_zero(attribute_of(request, sizeof wish, IFLA_IFNAME));
        for (const Interface& one : wire::kInterfaces)
            if (is_asked_for(one, wish.ifi_index, name))
                add_link(out, one, place_.address, one.is_loopback() ? loopback_ : wireless_, flags);
        if (!all && wish.ifi_index == 0 && name.empty()) error = EINVAL;
        if (!all && out.empty()) error = ENODEV;
        break;
    }
    case RTM_GETADDR: {
        const auto wish = body_of<ifaddrmsg>(request);
        if (wish.ifa_family != AF_UNSPEC && wish.ifa_family != AF_INET) break;
        for (const Interface& one : wire::kInterfaces)
            if (is_asked_for(one, static_cast<int>(wish.ifa_index), {}))
                add_address(out, one, place_.address, place_.prefix(), flags);
        if (!all) error = EOPNOTSUPP;
        break;
    }
    case RTM_GETROUTE: {
        const auto wish = body_of<rtmsg>(request);
        if (wish.rtm_family != AF_UNSPEC && wish.rtm_family != AF_INET) break;
        const Interface &loopback = wire::kInterfaces[0], &wireless = wire::kInterfaces[1];
        if (all) {
            add_way(out, place_.address & place_.mask, place_.prefix(), wireless, place_.address, flags);
            break;
        }
        const protocols::IpAddress to = address_in(attribute_of(request, sizeof wish, RTA_DST)),
                                   source = source_for(to);
        constexpr int kWhole = 32;
        if (source == 0)
            error = ENETUNREACH;
        else
            add_way(out, to, kWhole, is_own(to) ? loopback : wireless, is_own(to) ? to : source, flags);
        break;
    }
    case RTM_GETNEIGH:
    case RTM_GETRULE:
        if (!all) error = head.nlmsg_type == RTM_GETNEIGH ? ENOENT : EOPNOTSUPP;
        break;
    default: {
        // Each kind has four: new, del, get, set (uapi/linux/rtnetlink.h).
        constexpr int kKinds = 4, kGet = 2;
        const bool changes = (head.nlmsg_type - RTM_BASE) % kKinds != kGet;
        error = changes ? EPERM : EOPNOTSUPP;
    }
    }
    if (error != 0) out.take();
    if (!out.empty()) put_answer(socket, out.take(), now);
    if (error == 0 && all) {
        out.begin(NLMSG_DONE, NLM_F_MULTI, int{0});
        put_answer(socket, out.take(), now);
    } else if (error != 0 || (head.nlmsg_flags & NLM_F_ACK) != 0) {
        // The request follows, of success its head alone.
        out.begin(NLMSG_ERROR, 0, nlmsgerr{-error, head});
        if (error != 0) out.raw(request.substr(sizeof head));
        put_answer(socket, out.take(), now);
    }
}

void NetworkStack::put_answer(Socket& socket, std::string message, Time now) {
    const std::size_t size = message.size() + Socket::kDatagramCost;
    if (socket.queued + size > static_cast<std::size_t>(socket.options.receive_buffer)) {
        socket.error = ENOBUFS;
        return;
    }
    socket.queue.push_back({{}, std::move(message), now, 0, 0, 0});
    socket.queued += size;
    ++socket.activity;
}

}  // namespace puckloop::linuxboard
