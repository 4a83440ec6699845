// What the network gives programs, beside laws that are known: TCP's throughput against loss, round-trip
// times against distance and load; and what floods and half-open connections do to a board.

#include "cosim/faults/kinds/kind_table.h"
#include "cosim/faults/node_fault.h"
#include "linuxboard/shim/network/network_stack.h"
#include "tests/network/wifi_kit.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cmath>

using namespace puckloop;
using namespace puckloop::tests;
using cosim::kMillisecond;
using cosim::kSecond;
using cosim::Time;
using linuxboard::NetworkStack;

namespace {

bool shows_figures() {
    return std::getenv("PUCKLOOP_SHOW_FIGURES") != nullptr;
}

linuxboard::NetworkSpec board(const char* address) {
    return {address, 24, {{"a", "10.0.0.1"}, {"b", "10.0.0.2"}, {"c", "10.0.0.3"}}};
}

/// Two boards at a medium without limit of rate, `latency` from one to the other, which loses packets of `a`.
class Pair {
  public:
    Pair(Time latency, double loss, std::uint64_t seed)
        : step_(latency / 100), node_(spec(latency, loss, seed)) {}

    NetworkStack a{board("10.0.0.1"), RandomStream(1, "a")}, b{board("10.0.0.2"), RandomStream(1, "b")};
    Time now = 0;

    /// `each()` after each instant at which something happened.
    template <typename Each>
    void pass(Time duration, const Each& each) {
        const Time end = now + duration;
        for (; now < end; now += step_) {
            std::vector<cosim::Message> inbox, outbox;
            for (auto& [stack, port] : {std::pair{&a, 0}, {&b, 1}}) {
                if (stack->next_event() <= now) stack->advance(now);
                for (const linuxboard::PacketOut& packet : stack->take_packets())
                    inbox.push_back(
                        {now, static_cast<cosim::PortIndex>(port), cosim::Packet{now, 0, packet.octets}});
            }
            node_.advance(now + step_, inbox, outbox);
            for (const cosim::Message& message : outbox)
                (message.port == 0 ? a : b)
                    .receive_packet(std::get<cosim::Packet>(message.payload).octets.view(), now);
            if (!outbox.empty() || !inbox.empty()) each();
        }
    }
    void pass(Time duration) {
        pass(duration, [] {});
    }

  private:
    static network::NetworkSpec spec(Time latency, double loss, std::uint64_t seed) {
        network::NetworkSpec spec = three(latency);
        if (loss == 0) return spec;
        cosim::FaultSpec fault;
        fault.node = fault.name = "network";
        fault.kind = "loss";
        fault.from = "a";
        fault.probability = loss;
        cosim::complete(fault, *cosim::find_kind("loss", cosim::PlaceKind::Network));
        spec.faults = cosim::carried({{fault, seed, 0}});
        return spec;
    }

    Time step_;
    network::NetworkNode node_;
};

struct Connected {
    int client = -1, server = -1, listener = -1;
};

Connected connect(Pair& pair, int backlog = 5) {
    Connected ends;
    ends.listener = pair.b.open(true);
    REQUIRE(pair.b.bind(ends.listener, {0, 7000}) == 0);
    REQUIRE(pair.b.listen(ends.listener, backlog) == 0);
    ends.client = pair.a.open(true);
    REQUIRE(pair.a.connect(ends.client, {kFirst + 1, 7000}, pair.now) == EINPROGRESS);
    pair.pass(10 * kSecond);
    REQUIRE(pair.a.connecting(ends.client) == 0);
    ends.server = pair.b.accept(ends.listener);
    REQUIRE(ends.server >= 0);
    return ends;
}

/// bit/s that a program gets which always has something to send.
double throughput(Time round_trip, double loss, std::uint64_t seed, Time duration) {
    Pair pair(round_trip / 2, loss, seed);
    const Connected ends = connect(pair);
    const std::string data(16'384, 'x');
    std::uint64_t received = 0;
    const auto use = [&] {
        for (std::size_t taken = 1; taken > 0;) {
            taken = 0;
            if (pair.a.send(ends.client, {}, data, taken, pair.now) != 0) break;
        }
        for (;;) {
            NetworkStack::Received one;
            if (pair.b.receive(ends.server, 65'536, false, one, pair.now) != 0 || one.data.empty()) break;
            received += one.data.size();
        }
    };
    use();
    pair.pass(duration, use);
    return 8.0 * static_cast<double>(received) / cosim::to_seconds(duration);
}

/// Round-trip times, s, of `count` echoes from station `from` to `to`, one each `period`, beside what else is
/// sent. 10 us too long at most: who answers does so at the next grant.
std::vector<double> echoes(const wifi::WifiSpec& spec, std::size_t from, std::size_t to, int count,
                           Time period, const std::vector<cosim::Message>& load = {}) {
    constexpr Time kGrant = 10 * cosim::kMicrosecond;
    const auto address = [](std::size_t one) { return kFirst + static_cast<protocols::IpAddress>(one); };
    wifi::WifiNode node(spec);
    std::vector<double> times;
    std::vector<cosim::Message> inbox, outbox;
    std::size_t next = 0;
    for (Time now = 0; now < period * count + kSecond; now += kGrant) {
        if (now % period == 0 && now / period < count)
            inbox.push_back(packet(now, from, address(to), fmt::format("ping {}", now)));
        for (; next < load.size() && load[next].time < now + kGrant; ++next)
            inbox.push_back(load[next]);
        outbox.clear();
        node.advance(now + kGrant, inbox, outbox);
        inbox.clear();
        for (const cosim::Message& message : outbox) {
            const auto read = protocols::decode_ip(std::get<cosim::Packet>(message.payload).octets.view());
            const std::string text = protocols::decode_udp(*read)->data.c_str();
            if (message.port == to && text.starts_with("ping"))
                inbox.push_back(packet(now + kGrant, to, address(from), "pong" + text.substr(4)));
            if (message.port == from && text.starts_with("pong"))
                times.push_back(cosim::to_seconds(message.time - std::stoll(text.substr(5))));
        }
    }
    std::sort(times.begin(), times.end());
    return times;
}

double part_of(const std::vector<double>& sorted, double part) {
    return sorted.at(static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1)));
}

}  // namespace

TEST_CASE("TCP's throughput against loss is the square-root law's within 20 %", "[network][figures]") {
    // M. Mathis et al., The macroscopic behavior of the TCP congestion avoidance algorithm, 1997: a segment
    // over the round-trip time, times C / sqrt(p). C is sqrt(3 / 2) = 1.22 where each segment is
    // acknowledged; with an acknowledgement for two (delayed ones, RFC 1122) windows grow half as fast:
    // sqrt(3 / 4) = 0.87. Conditions: losses one by one, of data only; a window that loss and not the
    // receiver limits (0.87 / sqrt(p) segments, below the 44 of 65,535 octets, and above the 4 that fast
    // retransmission needs).
    constexpr double kSegment = 1460, kConstant = 0.866;
    for (const Time round_trip : {50 * kMillisecond, 200 * kMillisecond})
        for (const double loss : {0.002, 0.005, 0.01, 0.02}) {
            double got = 0;
            constexpr int kSeeds = 2;
            for (int seed = 1; seed <= kSeeds; ++seed)
                got += throughput(round_trip, loss, static_cast<std::uint64_t>(seed), 300 * kSecond) / kSeeds;
            const double law = 8 * kSegment / cosim::to_seconds(round_trip) * kConstant / std::sqrt(loss);
            INFO(cosim::to_seconds(round_trip)
                 << " s, loss " << loss << ": " << got / 1e6 << " Mbit/s, by the law " << law / 1e6);
            if (shows_figures())
                fmt::print("rtt {:3.0f} ms, loss {:.1f} %: {:.3f} Mbit/s, law {:.3f} ({:+.0f} %)\n",
                           1e3 * cosim::to_seconds(round_trip), 100 * loss, got / 1e6, law / 1e6,
                           100 * (got / law - 1));
            CHECK(got == Approx(law).epsilon(0.20));
        }
}

TEST_CASE("without loss the window over the round-trip time is what a connection gets",
          "[network][figures]") {
    CHECK(throughput(100 * kMillisecond, 0.0, 1, 60 * kSecond) == Approx(8 * 65'535 / 0.1).epsilon(0.05));
}

TEST_CASE("echoes take two frames' time, by the rate that distance leaves", "[network][figures]") {
    // Without an access point and with nothing else on the air: preamble, data in symbols of 4 us and 6 us
    // behind them, twice, and twice the latency. -25.2 dBm at 1 m, 30 dB less for each tenfold distance.
    for (const auto& [distance, rate] : {std::pair(2.0, 54), {20.0, 36}, {30.0, 24}, {40.0, 18}, {60.0, 6}}) {
        wifi::WifiSpec spec;
        spec.settings.shadowing = 0;
        spec.latency = kMillisecond / 2;
        spec.stations = {{.computer = {"s0", "10.0.0.1"}},
                         {.computer = {"s1", "10.0.0.2"}, .at = {distance, 0}}};
        const std::vector<double> times = echoes(spec, 0, 1, 50, 20 * kMillisecond);
        REQUIRE(times.size() == 50);
        const double frame = 26e-6 + 4e-6 * std::ceil((22 + 8 * 136) / (4.0 * rate));
        const double expected = 2 * (frame + 0.5e-3);
        const double median = part_of(times, 0.5);
        INFO(distance << " m: " << median << " s, expected " << expected);
        if (shows_figures())
            fmt::print("{:4.0f} m, {:2} Mbit/s: {:.3f} ms, expected {:.3f}\n", distance, rate, 1e3 * median,
                       1e3 * expected);
        CHECK(median >= expected);
        CHECK(median <= expected + 20e-6);
    }
}

TEST_CASE("echoes through an access point wait for what else is sent", "[network][figures]") {
    // Four stations send datagrams of 1500 octets at even times to a host by wire, and a fifth asks another
    // one.
    double before = 0;
    for (const double load : {0.0, 0.25, 0.5, 0.75, 0.9}) {
        wifi::WifiSpec spec = ring(6);
        spec.settings.standard = "g";
        spec.settings.rate = 54e6;
        constexpr double kSaturated = 30e6;  // bit/s of payload, of 4 stations (docs/network.md)
        std::vector<cosim::Message> sent;
        if (load > 0) {
            const double gap = kFloodPayload / (load * kSaturated);  // s, from one datagram to the next
            for (int i = 0; gap * i < 5.0; ++i)
                sent.push_back(packet(cosim::from_seconds(gap * i), static_cast<std::size_t>(i % 4),
                                      kFirst + 253, "load", kFloodOctets));
        }
        const std::vector<double> times = echoes(spec, 4, 5, 200, 23 * kMillisecond, sent);
        const double median = part_of(times, 0.5), most = part_of(times, 0.95);
        INFO(load << ": " << median << " s, 95 % " << most);
        if (shows_figures())
            fmt::print("load {:.0f} %: median {:.2f} ms, 95 % {:.2f} ms, of 200 came {}\n", 100 * load,
                       1e3 * median, 1e3 * most, times.size());
        CHECK(times.size() >= 198);
        CHECK(median > before);
        CHECK(median < 0.01);
        before = median;
    }
}

TEST_CASE("a flood of datagrams fills buffers and nothing else", "[network][figures]") {
    Pair pair(kMillisecond, 0.0, 1);
    const int sender = pair.a.open(false), receiver = pair.b.open(false), other = pair.b.open(false);
    REQUIRE(pair.b.bind(receiver, {0, 5000}) == 0);
    REQUIRE(pair.b.bind(other, {0, 5001}) == 0);
    const std::string data(1000, 'x');
    std::size_t taken = 0;
    constexpr int kSent = 20'000;
    for (int i = 0; i < kSent; ++i)
        CHECK(pair.a.send(sender, linuxboard::Endpoint{kFirst + 1, 5000}, data, taken, pair.now) == 0);
    CHECK(pair.a.send(sender, linuxboard::Endpoint{kFirst + 1, 5001}, "through", taken, pair.now) == 0);
    pair.pass(kSecond);
    // 212,992 octets, 1768 for each with what the kernel needs.
    CHECK(pair.b.counts().datagrams_received == 212'992 / 1768 + 1);
    CHECK(pair.b.counts().datagrams_dropped == kSent - 212'992 / 1768);
    NetworkStack::Received one;
    CHECK(pair.b.receive(other, 100, false, one, pair.now) == 0);
    CHECK(one.data == "through");
}

TEST_CASE("connections that are half open fill the backlog, go by themselves, and let others in",
          "[network][figures]") {
    Pair pair(kMillisecond, 0.0, 1);
    const int listener = pair.b.open(true);
    REQUIRE(pair.b.bind(listener, {0, 7000}) == 0);
    REQUIRE(pair.b.listen(listener, 8) == 0);
    // SYNs of a computer that answers nothing, as floods have them.
    for (std::uint16_t port = 1; port <= 500; ++port) {
        protocols::TcpSegment syn;
        syn.from_port = port;
        syn.to_port = 7000;
        syn.sequence = port * 1000U;
        syn.flags = protocols::kSyn;
        protocols::IpPacket packet;
        packet.from = kFirst + 2;
        packet.to = kFirst + 1;
        packet.protocol = protocols::kTcp;
        packet.payload = protocols::encode_tcp(syn, packet.from, packet.to);
        pair.b.receive_packet(protocols::encode(packet), pair.now);
    }
    CHECK(pair.b.counts().connections == 9);  // the backlog and one more, as Linux has it
    const int client = pair.a.open(true);
    REQUIRE(pair.a.connect(client, {kFirst + 1, 7000}, pair.now) == EINPROGRESS);
    pair.pass(5 * kSecond);
    CHECK(pair.a.connecting(client) == EINPROGRESS);  // its SYN is dropped, and comes again
    // After five answers that nobody takes (63 s) there is room; the SYN of 63 s finds it.
    pair.pass(125 * kSecond);
    CHECK(pair.a.connecting(client) == 0);
    const int server = pair.b.accept(listener);
    CHECK(server >= 0);
    CHECK(pair.b.accept(listener) == -1);
}

TEST_CASE("an end that is gone without a word is found out by who sends to it", "[network][figures]") {
    Pair pair(kMillisecond, 0.0, 1);
    const Connected ends = connect(pair);
    // The other board restarts: it knows nothing of the connection.
    pair.b = NetworkStack(board("10.0.0.2"), RandomStream(2, "b"));
    pair.pass(100 * kSecond);
    CHECK((pair.a.events(ends.client) & (POLLIN | POLLERR)) == 0);  // nothing was sent, and nothing is known
    std::size_t taken = 0;
    CHECK(pair.a.send(ends.client, {}, "x", taken, pair.now) == 0);
    pair.pass(kSecond);
    NetworkStack::Received one;
    CHECK(pair.a.receive(ends.client, 10, false, one, pair.now) == ECONNRESET);
    CHECK(pair.b.counts().no_port == 1);
}
