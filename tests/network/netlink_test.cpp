// NETLINK_ROUTE: what a board's kernel answers about its interfaces, addresses and ways; requests that are
// none.

#include "linuxboard/shim/network/network_stack.h"

#include <catch2/catch.hpp>

#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>

#include <cerrno>
#include <cstring>
#include <map>
#include <string>
#include <vector>

using namespace puckloop;
using namespace puckloop::linuxboard;

namespace {

/// A request as a program sends it: body, then attributes.
template <typename Body>
std::string request(std::uint16_t type, std::uint16_t flags, const Body& body,
                    const std::vector<std::pair<std::uint16_t, std::string>>& attributes = {}) {
    std::string text(NLMSG_HDRLEN, '\0');
    text.append(reinterpret_cast<const char*>(&body), sizeof body);
    text.resize(NLMSG_ALIGN(text.size()));
    for (const auto& [kind, value] : attributes) {
        const rtattr head{static_cast<unsigned short>(RTA_LENGTH(value.size())), kind};
        text.append(reinterpret_cast<const char*>(&head), sizeof head);
        text += value;
        text.resize(NLMSG_ALIGN(text.size()));
    }
    nlmsghdr head{};
    head.nlmsg_len = static_cast<std::uint32_t>(text.size());
    head.nlmsg_type = type;
    head.nlmsg_flags = static_cast<std::uint16_t>(NLM_F_REQUEST | flags);
    head.nlmsg_seq = 77;
    std::memcpy(text.data(), &head, sizeof head);
    return text;
}

struct Answer {
    nlmsghdr head{};
    std::string body;

    template <typename Body>
    Body as() const {
        Body body_as{};
        REQUIRE(body.size() >= sizeof body_as);
        std::memcpy(&body_as, body.data(), sizeof body_as);
        return body_as;
    }
    /// Attributes behind a body of so many octets.
    std::map<int, std::string> attributes(std::size_t size) const {
        std::map<int, std::string> all;
        rtattr one{};
        for (std::size_t at = NLMSG_ALIGN(size); at + sizeof one <= body.size();
             at += RTA_ALIGN(one.rta_len)) {
            std::memcpy(&one, body.data() + at, sizeof one);
            REQUIRE(one.rta_len >= sizeof one);
            all[one.rta_type] = body.substr(at + sizeof one, one.rta_len - sizeof one);
        }
        return all;
    }
};

class Asker {
  public:
    Asker() : socket_(stack_.open(SocketKind::Netlink)) { REQUIRE(stack_.bind(socket_, {}) == 0); }

    std::vector<Answer> ask(const std::string& text) {
        std::size_t taken = 0;
        REQUIRE(stack_.send(socket_, Endpoint{}, text, taken, 0) == 0);
        CHECK(taken == text.size());
        return answers();
    }
    std::vector<Answer> answers() {
        std::vector<Answer> all;
        NetworkStack::Received got;
        while (stack_.receive(socket_, 65'535, false, got, 0) == 0) {
            for (std::size_t at = 0; at < got.data.size();) {
                Answer& one = all.emplace_back();
                std::memcpy(&one.head, got.data.data() + at, sizeof one.head);
                REQUIRE(one.head.nlmsg_len >= sizeof one.head);
                REQUIRE(at + one.head.nlmsg_len <= got.data.size());
                one.body = got.data.substr(at + NLMSG_HDRLEN, one.head.nlmsg_len - NLMSG_HDRLEN);
                at += NLMSG_ALIGN(one.head.nlmsg_len);
                Endpoint own;
                stack_.name_of(socket_, false, own);
                CHECK(one.head.nlmsg_pid == own.address);
                CHECK(one.head.nlmsg_seq == 77);
            }
        }
        return all;
    }
    int error_of(const std::string& text) {
        const auto all = ask(text);
        REQUIRE(all.size() == 1);
        REQUIRE(all[0].head.nlmsg_type == NLMSG_ERROR);
        return -all[0].as<nlmsgerr>().error;
    }
    NetworkStack& stack() { return stack_; }
    int socket() const { return socket_; }

  private:
    NetworkStack stack_{NetworkSpec{"10.0.0.7", 24, {{"a", "10.0.0.7"}, {"b", "10.0.0.8"}}},
                        RandomStream(1, "a")};
    int socket_;
};

std::string word(std::uint32_t value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
}

}  // namespace

TEST_CASE("netlink: interfaces, all and one", "[network][netlink]") {
    Asker asker;
    const auto all = asker.ask(request(RTM_GETLINK, NLM_F_DUMP, ifinfomsg{}));
    REQUIRE(all.size() == 3);
    CHECK(all[2].head.nlmsg_type == NLMSG_DONE);
    const auto wireless = all[1].as<ifinfomsg>();
    CHECK(wireless.ifi_index == 2);
    CHECK((wireless.ifi_flags & IFF_UP) != 0);
    auto attributes = all[1].attributes(sizeof wireless);
    CHECK(attributes[IFLA_IFNAME] == std::string("wlan0\0", 6));
    CHECK(attributes[IFLA_ADDRESS] == std::string("\x02\0\x0a\0\0\x07", 6));
    CHECK(attributes[IFLA_MTU] == word(1500));
    const auto one = asker.ask(request(RTM_GETLINK, 0, ifinfomsg{}, {{IFLA_IFNAME, std::string("lo\0", 3)}}));
    REQUIRE(one.size() == 1);
    CHECK(one[0].as<ifinfomsg>().ifi_index == 1);
    ifinfomsg third{};
    third.ifi_index = 3;
    CHECK(asker.error_of(request(RTM_GETLINK, 0, third)) == ENODEV);
    CHECK(asker.error_of(request(RTM_GETLINK, 0, ifinfomsg{})) == EINVAL);
}

TEST_CASE("netlink: addresses and ways", "[network][netlink]") {
    Asker asker;
    const auto all = asker.ask(request(RTM_GETADDR, NLM_F_DUMP, ifaddrmsg{}));
    REQUIRE(all.size() == 3);
    CHECK(all[0].as<ifaddrmsg>().ifa_prefixlen == 8);
    CHECK(all[1].as<ifaddrmsg>().ifa_prefixlen == 24);
    CHECK(all[1].attributes(sizeof(ifaddrmsg))[IFA_BROADCAST] == word(htonl(0x0a0000ff)));
    ifaddrmsg six{};
    six.ifa_family = AF_INET6;
    CHECK(asker.ask(request(RTM_GETADDR, NLM_F_DUMP, six)).size() == 1);  // the end alone
    const auto ways = asker.ask(request(RTM_GETROUTE, NLM_F_DUMP, rtmsg{}));
    REQUIRE(ways.size() == 2);
    CHECK(ways[0].attributes(sizeof(rtmsg))[RTA_DST] == word(htonl(0x0a000000)));
    const auto way = asker.ask(request(RTM_GETROUTE, 0, rtmsg{}, {{RTA_DST, word(htonl(0x0a000008))}}));
    REQUIRE(way.size() == 1);
    CHECK(way[0].attributes(sizeof(rtmsg))[RTA_OIF] == word(2));
    CHECK(asker.error_of(request(RTM_GETROUTE, 0, rtmsg{}, {{RTA_DST, word(htonl(0x08080808))}})) ==
          ENETUNREACH);
    CHECK(asker.ask(request(RTM_GETNEIGH, NLM_F_DUMP, ndmsg{})).size() == 1);
}

TEST_CASE("netlink: changes and what is not known are refused, as is what is no request",
          "[network][netlink]") {
    Asker asker;
    CHECK(asker.error_of(request(RTM_NEWLINK, 0, ifinfomsg{})) == EPERM);
    CHECK(asker.error_of(request(RTM_DELADDR, NLM_F_ACK, ifaddrmsg{})) == EPERM);
    CHECK(asker.error_of(request(RTM_GETQDISC, NLM_F_DUMP, tcmsg{})) == EOPNOTSUPP);
    ifinfomsg loopback{};
    loopback.ifi_index = 1;
    const auto acknowledged = asker.ask(request(RTM_GETLINK, NLM_F_ACK, loopback));
    REQUIRE(acknowledged.size() == 2);
    CHECK(acknowledged[1].as<nlmsgerr>().error == 0);
    const std::string whole = request(RTM_GETLINK, NLM_F_DUMP, ifinfomsg{});
    for (std::size_t size = 0; size < whole.size(); ++size)
        CHECK(asker.ask(whole.substr(0, size)).empty());
    CHECK(asker.ask(whole + whole).size() == 6);
    // A head alone: the body is zeros. An attribute longer than there is.
    std::string head = whole.substr(0, NLMSG_HDRLEN);
    const std::string size = word(NLMSG_HDRLEN);
    head.replace(0, size.size(), size);
    CHECK(asker.ask(head).size() == 3);
    std::string torn = request(RTM_GETLINK, 0, ifinfomsg{}, {{IFLA_IFNAME, std::string("lo\0", 3)}});
    torn[NLMSG_HDRLEN + sizeof(ifinfomsg)] = 127;
    CHECK(asker.error_of(torn) == EINVAL);
}

TEST_CASE("netlink: what nobody reads fills the buffer, and is said once", "[network][netlink]") {
    Asker asker;
    std::size_t taken = 0;
    const std::string text = request(RTM_GETLINK, NLM_F_DUMP, ifinfomsg{});
    for (int i = 0; i < 300; ++i) {
        const int error = asker.stack().send(asker.socket(), Endpoint{}, text, taken, 0);
        CHECK((error == 0 || error == ENOBUFS));
    }
    CHECK((asker.stack().events(asker.socket()) & POLLERR) != 0);
    NetworkStack::Received got;
    CHECK(asker.stack().receive(asker.socket(), 100, false, got, 0) == ENOBUFS);
    CHECK(asker.stack().receive(asker.socket(), 100, false, got, 0) == 0);
    CHECK(got.size > 100);
    // A datagram never comes to such a socket, nor is it in the tables of others.
    CHECK(asker.stack().table(NetworkTable::Datagrams).find('\n') ==
          asker.stack().table(NetworkTable::Datagrams).size() - 1);
}
