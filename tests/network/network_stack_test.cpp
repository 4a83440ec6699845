// Sockets of two boards whose packets are carried by hand.

#include "linuxboard/shim/network/network_stack.h"

#include "protocols/network/dns_message.h"

#include <catch2/catch.hpp>

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

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

TEST_CASE("a socket may connect to itself, and two to each other at once", "[network]") {
    Boards boards;
    NetworkStack& a = boards.a;
    const int self = a.open(true);
    REQUIRE(a.bind(self, {kLocalHost, 7000}) == 0);
    CHECK(a.connect(self, {kLocalHost, 7000}, 0) == EINPROGRESS);
    CHECK(a.events(self) == 0);
    boards.pass(kMillisecond);
    CHECK(a.connecting(self) == 0);
    std::size_t taken = 0;
    CHECK(a.send(self, std::nullopt, "me", taken, boards.now) == 0);
    boards.pass(kMillisecond);
    CHECK(received(a, self, boards.now) == "me");
    const int left = a.open(true), right = boards.b.open(true);
    REQUIRE(a.bind(left, {0, 7001}) == 0);
    REQUIRE(boards.b.bind(right, {0, 7002}) == 0);
    CHECK(a.connect(left, {kB, 7002}, boards.now) == EINPROGRESS);
    CHECK(boards.b.connect(right, {kA, 7001}, boards.now) == EINPROGRESS);
    boards.pass(10 * kMillisecond);
    CHECK(a.connecting(left) == 0);
    CHECK(boards.b.connecting(right) == 0);
    CHECK(a.send(left, std::nullopt, "both", taken, boards.now) == 0);
    boards.pass(10 * kMillisecond);
    CHECK(received(boards.b, right, boards.now) == "both");
    boards.a.close_all(boards.now);
    boards.b.close_all(boards.now);
    boards.pass(200 * kSecond);
    CHECK(a.next_event() == cosim::kNever);
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

namespace {
/// A query for `name`, of type A or PTR.
std::string dns_query(const std::string& name, std::uint16_t type = protocols::kDnsAddress) {
    const std::string head("\x12\x34\x01\0\0\x01\0\0\0\0\0\0", 12);
    return head + protocols::dns_data(name) + '\0' + static_cast<char>(type) + std::string("\0\1", 2);
}
}  // namespace

TEST_CASE("the board's resolver knows the computers of the network", "[network][dns]") {
    Boards boards;
    NetworkStack& a = boards.a;
    const int socket = a.open(false);
    const Endpoint resolver{kResolver, protocols::kDnsPort};
    REQUIRE(a.connect(socket, resolver, 0) == 0);
    const auto ask = [&](const std::string& name, std::uint16_t type = protocols::kDnsAddress) {
        std::size_t taken = 0;
        REQUIRE(a.send(socket, std::nullopt, dns_query(name, type), taken, boards.now) == 0);
        boards.pass(kMillisecond);
        return received(a, socket, boards.now);
    };
    const auto status = [](const std::string& answer) { return answer.size() < 12 ? -1 : answer[3] & 0xf; };
    CHECK(ask("b").ends_with(std::string("\0\4\x0a\0\0\2", 6)));
    CHECK(ask("B").ends_with(std::string("\0\4\x0a\0\0\2", 6)));
    CHECK(ask("localhost").ends_with(std::string("\0\4\x7f\0\0\1", 6)));
    CHECK(ask("2.0.0.10.in-addr.arpa", protocols::kDnsPointer).ends_with(std::string("\0\3\1b\0", 5)));
    // Such a name, but no such record; nobody's name; nobody's address.
    constexpr std::uint16_t kSixAddress = 28;
    const std::string none = ask("b", kSixAddress);
    CHECK(status(none) == 0);
    CHECK(none.substr(6, 2) == std::string("\0\0", 2));
    CHECK(status(ask("nobody")) == 3);
    CHECK(status(ask("9.0.0.10.in-addr.arpa", protocols::kDnsPointer)) == 3);
    CHECK(a.unknown_names() == std::set<std::string>{"9.0.0.10.in-addr.arpa", "nobody"});
    CHECK(boards.packets == 0);  // nothing of it is on the network
    bool silent = true;
    std::string asked;
    a.set_silence([&](Time, std::string_view name) {
        asked = name;
        return silent;
    });
    CHECK(ask("b").empty());
    CHECK(asked == "b");
    silent = false;
    CHECK(status(ask("b")) == 0);
    CHECK(a.bind(a.open(false), resolver) == EADDRINUSE);
}

TEST_CASE("echoes are answered by the other board, and come back to the socket that sent them", "[network]") {
    Boards boards;
    NetworkStack& a = boards.a;
    const int first = a.open(SocketKind::Echo), second = a.open(SocketKind::Echo);
    const auto ask = [&](int socket, const std::string& message, protocols::IpAddress to = kB) {
        return send_to(a, socket, {to, 0}, message, boards.now);
    };
    // Type, code, checksum, identifier, sequence number, data.
    const std::string echo("\x08\0..??\0\7data", 12);
    CHECK(ask(first, "short") == EINVAL);
    CHECK(ask(first, "no echo request") == EINVAL);
    CHECK(ask(first, echo, 0x08080808) == ENETUNREACH);
    CHECK(ask(first, echo, kAll) == EACCES);
    CHECK(ask(first, echo) == 0);
    CHECK(ask(second, echo) == 0);
    boards.pass(kMillisecond);
    CHECK(boards.packets == 4);
    Endpoint own;
    for (const int socket : {first, second}) {
        NetworkStack::Received one;
        REQUIRE(a.receive(socket, 100, false, one, boards.now) == 0);
        CHECK(one.from == Endpoint{kB, 0});
        CHECK(one.time_to_live == 64);
        CHECK(one.data.substr(0, 2) == std::string("\0\0", 2));
        CHECK(one.data.substr(6) == std::string("\0\7data", 6));
        REQUIRE(a.name_of(socket, false, own) == 0);
        CHECK(one.data.substr(4, 2) ==
              std::string{static_cast<char>(own.port >> 8), static_cast<char>(own.port)});
        CHECK(a.receive(socket, 100, false, one, boards.now) == EAGAIN);
    }
    // Its own address, and one that nobody has.
    CHECK(ask(first, echo, kA) == 0);
    CHECK(ask(first, echo, kNobody) == 0);
    boards.pass(kMillisecond);
    CHECK(boards.packets == 4);
    CHECK(received(a, first, boards.now).size() == echo.size());
    CHECK(received(a, first, boards.now).empty());
}

TEST_CASE("keep-alive finds out that the other board restarted", "[network]") {
    Boards boards;
    const auto [client, server] = boards.connected();
    set_flag(boards.a, client, SOL_SOCKET, SO_KEEPALIVE, 1);
    for (const int times : {TCP_KEEPIDLE, TCP_KEEPINTVL})
        set_flag(boards.a, client, IPPROTO_TCP, times, 5);
    boards.pass(12 * kSecond);
    CHECK(boards.a.events(client) == (POLLOUT | POLLWRNORM));
    boards.b = NetworkStack(spec_of("10.0.0.2"), RandomStream(2, "b"));
    boards.pass(6 * kSecond);
    CHECK((boards.a.events(client) & (POLLIN | POLLERR | POLLHUP)) == (POLLIN | POLLERR | POLLHUP));
    NetworkStack::Received one;
    CHECK(boards.a.receive(client, 1, false, one, boards.now) == ECONNRESET);
    CHECK(boards.b.counts().no_port == 1);
}

TEST_CASE("the board's /proc/net has its interfaces, ways and sockets", "[network]") {
    Boards boards;
    const auto [client, server] = boards.connected();
    const auto rows = [&](NetworkTable which) {
        std::vector<std::string> lines;
        std::istringstream text(boards.b.table(which));
        for (std::string line; std::getline(text, line);)
            lines.push_back(line.substr(0, line.find_last_not_of(' ') + 1));
        return lines;
    };
    const std::string rest =
        " 00000000:00000000 00:00000000 00000000     0        0 0 1 0000000000000000 100 0 0 10 0";
    const auto streams = rows(NetworkTable::Streams);
    REQUIRE(streams.size() == 3);
    CHECK(streams[1] == "   0: 00000000:1B58 00000000:0000 0A" + rest);
    CHECK(streams[2].starts_with("   1: 0200000A:1B58 0100000A:"));
    CHECK(streams[2].ends_with(" 01" + rest));
    std::size_t taken = 0;
    CHECK(boards.a.send(client, std::nullopt, "unread", taken, boards.now) == 0);
    boards.pass(kMillisecond);
    CHECK(rows(NetworkTable::Streams)[2].find(" 01 00000000:00000006 ") != std::string::npos);
    const int datagrams = boards.b.open(false);
    REQUIRE(boards.b.bind(datagrams, {0, 5000}) == 0);
    REQUIRE(rows(NetworkTable::Datagrams).size() == 2);
    CHECK(rows(NetworkTable::Datagrams)[1].starts_with("    0: 00000000:1388 00000000:0000 07 "));
    // SYN and acknowledgement, 40 octets and 4 of an option; its answer; six octets of data; their
    // acknowledgement.
    const auto devices = rows(NetworkTable::Interfaces);
    REQUIRE(devices.size() == 4);
    CHECK(devices[2].starts_with("    lo:       0       0 "));
    CHECK(devices[3].starts_with(" wlan0:     130       3 "));
    CHECK(rows(NetworkTable::Routes)[1] == "wlan0\t0000000A\t00000000\t0001\t0\t0\t0\t00FFFFFF\t0\t0\t0");
    CHECK(rows(NetworkTable::Neighbours).size() == 1);
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
