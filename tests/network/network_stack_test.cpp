// Sockets of two boards whose packets are carried by hand.

#include "linuxboard/shim/network/network_stack.h"

#include <catch2/catch.hpp>

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

using namespace puckloop;
using namespace puckloop::linuxboard;
using cosim::kMillisecond;
using cosim::kSecond;
using cosim::Time;

namespace {

constexpr protocols::IpAddress kA = 0x0a000001, kB = 0x0a000002, kNobody = 0x0a000009, kAll = 0x0a0000ff,
                               kGroup = 0xe0000101;

NetworkSpec spec_of(const char* address) {
    return {address, 24, {{"a", "10.0.0.1"}, {"b", "10.0.0.2"}}};
}

struct Boards {
    NetworkStack a{spec_of("10.0.0.1"), RandomStream(1, "a")}, b{spec_of("10.0.0.2"), RandomStream(1, "b")};
    Time now = 0;
    std::size_t packets = 0;

    /// Packets and timers until nothing happens for `duration`.
    void pass(Time duration) {
        const Time end = now + duration;
        while (true) {
            bool moved = false;
            for (auto [from, to] : {std::pair{&a, &b}, std::pair{&b, &a}})
                for (const PacketOut& packet : from->take_packets()) {
                    now += kMillisecond;
                    to->receive_packet(packet.octets.view(), now);
                    moved = true;
                    ++packets;
                }
            if (moved) continue;
            const Time next = std::min(a.next_event(), b.next_event());
            if (next > end) break;
            now = std::max(now, next);
            a.advance(now);
            b.advance(now);
        }
        now = std::max(now, end);
    }
    std::pair<int, int> connected() {
        const int listener = b.open(true);
        REQUIRE(b.bind(listener, {0, 7000}) == 0);
        REQUIRE(b.listen(listener, 5) == 0);
        const int client = a.open(true);
        REQUIRE(a.connect(client, {kB, 7000}, now) == EINPROGRESS);
        pass(10 * kMillisecond);
        REQUIRE(a.connecting(client) == 0);
        const int server = b.accept(listener);
        REQUIRE(server >= 0);
        return {client, server};
    }
};

int set_flag(NetworkStack& stack, int socket, int level, int name, int value) {
    return stack.set_option(socket, level, name,
                            std::string_view(reinterpret_cast<const char*>(&value), sizeof value), 0);
}

std::string received(NetworkStack& stack, int socket, Time now) {
    NetworkStack::Received one;
    return stack.receive(socket, 100'000, false, one, now) == 0 ? one.data : "";
}

int send_to(NetworkStack& stack, int socket, Endpoint to, std::string_view data, Time now) {
    std::size_t taken = 0;
    return stack.send(socket, to, data, taken, now);
}

}  // namespace

TEST_CASE("a port is one socket's, unless both share it", "[network]") {
    Boards boards;
    NetworkStack& stack = boards.a;
    const int first = stack.open(false), second = stack.open(false);
    CHECK(stack.bind(first, {0, 5000}) == 0);
    CHECK(stack.bind(first, {0, 5001}) == EINVAL);
    CHECK(stack.bind(second, {kA, 5000}) == EADDRINUSE);
    CHECK(stack.bind(second, {kB, 5000}) == EADDRNOTAVAIL);
    CHECK(stack.bind(second, {0x08080808, 5000}) == EADDRNOTAVAIL);
    set_flag(stack, first, SOL_SOCKET, SO_REUSEADDR, 1);
    set_flag(stack, second, SOL_SOCKET, SO_REUSEADDR, 1);
    CHECK(stack.bind(second, {0, 5000}) == 0);
    // TCP's ports are others.
    const int stream = stack.open(true), other = stack.open(true);
    CHECK(stack.bind(stream, {0, 5000}) == 0);
    CHECK(stack.listen(stream, 1) == 0);
    set_flag(stack, stream, SOL_SOCKET, SO_REUSEADDR, 1);
    set_flag(stack, other, SOL_SOCKET, SO_REUSEADDR, 1);
    CHECK(stack.bind(other, {0, 5000}) == EADDRINUSE);  // somebody listens
}

TEST_CASE("datagrams: to one, to all, to a group, and to nobody", "[network]") {
    Boards boards;
    NetworkStack &a = boards.a, &b = boards.b;
    const int from = a.open(false), to = b.open(false);
    REQUIRE(b.bind(to, {0, 5000}) == 0);
    CHECK(send_to(a, from, {kB, 5000}, "one", boards.now) == 0);
    boards.pass(kMillisecond);
    CHECK(received(b, to, boards.now) == "one");
    CHECK(send_to(a, from, {kAll, 5000}, "all", boards.now) == EACCES);
    set_flag(a, from, SOL_SOCKET, SO_BROADCAST, 1);
    CHECK(send_to(a, from, {0xffffffff, 5000}, "all", boards.now) == 0);
    boards.pass(kMillisecond);
    CHECK(received(b, to, boards.now) == "all");
    CHECK(send_to(a, from, {kGroup, 5000}, "group", boards.now) == 0);
    boards.pass(kMillisecond);
    CHECK(received(b, to, boards.now).empty());
    ip_mreq wish{};
    wish.imr_multiaddr.s_addr = htonl(kGroup);
    const std::string_view bytes(reinterpret_cast<const char*>(&wish), sizeof wish);
    CHECK(b.set_option(to, IPPROTO_IP, IP_ADD_MEMBERSHIP, bytes, 0) == 0);
    CHECK(b.set_option(to, IPPROTO_IP, IP_ADD_MEMBERSHIP, bytes, 0) == EADDRINUSE);
    CHECK(send_to(a, from, {kGroup, 5000}, "group", boards.now) == 0);
    boards.pass(kMillisecond);
    CHECK(received(b, to, boards.now) == "group");
    CHECK(send_to(a, from, {0x08080808, 53}, "x", boards.now) == ENETUNREACH);
    CHECK(send_to(a, from, {kNobody, 53}, "x", boards.now) == 0);
    CHECK(a.counts().unreachable == 1);
    CHECK(send_to(a, from, {kB, 5000}, std::string(65'508, 'x'), boards.now) == EMSGSIZE);
}

TEST_CASE("a connected sender hears that the port is closed", "[network]") {
    Boards boards;
    const int socket = boards.a.open(false);
    REQUIRE(boards.a.connect(socket, {kB, 999}, 0) == 0);
    std::size_t taken = 0;
    CHECK(boards.a.send(socket, std::nullopt, "x", taken, 0) == 0);
    boards.pass(kMillisecond);
    CHECK((boards.a.events(socket) & POLLERR) != 0);
    CHECK(boards.a.send(socket, std::nullopt, "x", taken, 0) == ECONNREFUSED);
    CHECK(boards.a.send(socket, std::nullopt, "x", taken, 0) == 0);
}

TEST_CASE("a large datagram goes in fragments, and a missing one loses it", "[network]") {
    Boards boards;
    const int from = boards.a.open(false), to = boards.b.open(false);
    REQUIRE(boards.b.bind(to, {0, 5000}) == 0);
    const std::string large(60'000, 'f');
    CHECK(send_to(boards.a, from, {kB, 5000}, large, 0) == 0);
    boards.pass(kMillisecond);
    CHECK(boards.packets == 41);
    CHECK(received(boards.b, to, boards.now) == large);
    CHECK(send_to(boards.a, from, {kB, 5000}, large, boards.now) == 0);
    auto packets = boards.a.take_packets();
    packets.erase(packets.begin() + 7);
    for (const PacketOut& packet : packets)
        boards.b.receive_packet(packet.octets.view(), boards.now);
    CHECK(boards.b.readable(to) == 0);
}

TEST_CASE("a full receive buffer drops, and counts", "[network]") {
    Boards boards;
    const int from = boards.a.open(false), to = boards.b.open(false);
    REQUIRE(boards.b.bind(to, {0, 5000}) == 0);
    set_flag(boards.b, to, SOL_SOCKET, SO_RCVBUF, 5000);
    for (int i = 0; i < 20; ++i)
        send_to(boards.a, from, {kB, 5000}, std::string(1000, 'x'), boards.now);
    boards.pass(kMillisecond);
    CHECK(boards.b.counts().datagrams_received == 5);
    CHECK(boards.b.counts().datagrams_dropped == 15);
}

TEST_CASE("connections: refused, unreachable, outside", "[network]") {
    Boards boards;
    NetworkStack& a = boards.a;
    const int refused = a.open(true), nobody = a.open(true), outside = a.open(true);
    CHECK(a.connect(refused, {kB, 1}, 0) == EINPROGRESS);
    CHECK(a.connect(refused, {kB, 1}, 0) == EALREADY);
    CHECK(a.connect(nobody, {kNobody, 1}, 0) == EINPROGRESS);
    CHECK(a.connect(outside, {0x08080808, 1}, 0) == ENETUNREACH);
    boards.pass(10 * kMillisecond);
    CHECK(a.connecting(refused) == ECONNREFUSED);
    CHECK(a.connecting(nobody) == EINPROGRESS);
    boards.pass(3 * kSecond);
    CHECK(a.connecting(nobody) == EHOSTUNREACH);
}

TEST_CASE("a stream: data, end, and what poll sees of it", "[network]") {
    Boards boards;
    const auto [client, server] = boards.connected();
    CHECK(boards.a.events(client) == (POLLOUT | POLLWRNORM));
    const auto before = boards.b.activity(server);
    std::size_t taken = 0;
    CHECK(boards.a.send(client, std::nullopt, "hello", taken, boards.now) == 0);
    boards.pass(10 * kMillisecond);
    CHECK(boards.b.activity(server) != before);
    CHECK((boards.b.events(server) & POLLIN) != 0);
    CHECK(received(boards.b, server, boards.now) == "hello");
    CHECK((boards.b.events(server) & POLLIN) == 0);
    CHECK(boards.a.shutdown(client, SHUT_WR, boards.now) == 0);
    boards.pass(100 * kMillisecond);
    CHECK((boards.b.events(server) & (POLLIN | POLLRDHUP | POLLHUP)) == (POLLIN | POLLRDHUP));
    CHECK(boards.b.send(server, std::nullopt, "still open", taken, boards.now) == 0);
    boards.b.close(server, boards.now);
    boards.pass(100 * kMillisecond);
    CHECK(received(boards.a, client, boards.now) == "still open");
    CHECK(boards.a.send(client, std::nullopt, "x", taken, boards.now) == EPIPE);
}

TEST_CASE("a full backlog makes others wait, and nothing is left when all is closed", "[network]") {
    Boards boards;
    const int listener = boards.b.open(true);
    REQUIRE(boards.b.bind(listener, {0, 7000}) == 0);
    REQUIRE(boards.b.listen(listener, 1) == 0);
    std::vector<int> clients;
    for (int i = 0; i < 4; ++i) {
        clients.push_back(boards.a.open(true));
        CHECK(boards.a.connect(clients.back(), {kB, 7000}, boards.now) == EINPROGRESS);
    }
    boards.pass(500 * kMillisecond);
    const auto open = [&] {
        return std::count_if(clients.begin(), clients.end(),
                             [&](int one) { return boards.a.connecting(one) == 0; });
    };
    CHECK(open() == 2);
    CHECK(boards.b.accept(listener) >= 0);
    CHECK(boards.b.accept(listener) >= 0);
    CHECK(boards.b.accept(listener) == -1);
    boards.pass(2 * kSecond);  // the others' SYN, again
    CHECK(open() == 4);
    boards.a.close_all(boards.now);
    boards.b.close_all(boards.now);
    boards.pass(200 * kSecond);
    CHECK(boards.a.next_event() == cosim::kNever);
    CHECK(boards.b.next_event() == cosim::kNever);
}

TEST_CASE("a board talks to itself", "[network]") {
    Boards boards;
    NetworkStack& a = boards.a;
    const int listener = a.open(true), client = a.open(true);
    REQUIRE(a.bind(listener, {0x7f000001, 7000}) == 0);
    REQUIRE(a.listen(listener, 1) == 0);
    CHECK(a.connect(client, {0x7f000001, 7000}, 0) == EINPROGRESS);
    boards.pass(kMillisecond);
    CHECK(a.connecting(client) == 0);
    const int server = a.accept(listener);
    REQUIRE(server >= 0);
    std::size_t taken = 0;
    CHECK(a.send(client, std::nullopt, "me", taken, boards.now) == 0);
    boards.pass(kMillisecond);
    CHECK(received(a, server, boards.now) == "me");
    CHECK(boards.packets == 0);
}

TEST_CASE("a socket option that is not known is refused", "[network]") {
    Boards boards;
    const int stream = boards.a.open(true), datagram = boards.a.open(false);
    CHECK(set_flag(boards.a, stream, IPPROTO_TCP, 12'345, 1) == ENOPROTOOPT);
    CHECK(set_flag(boards.a, datagram, IPPROTO_TCP, 1, 1) == ENOPROTOOPT);
    std::string value;
    CHECK(boards.a.get_option(stream, SOL_SOCKET, SO_TYPE, value) == 0);
    int type = 0;
    std::memcpy(&type, value.data(), sizeof type);
    CHECK(type == SOCK_STREAM);
    CHECK(boards.a.set_option(stream, SOL_SOCKET, SO_REUSEADDR, "x", 0) == EINVAL);
}
