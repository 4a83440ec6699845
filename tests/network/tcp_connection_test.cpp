// Two ends of a TCP connection over a line that loses, doubles and reorders.

#include "linuxboard/shim/network/tcp_connection.h"

#include "base/random.h"
#include "linuxboard/shim/network/sequence.h"

#include <catch2/catch.hpp>

#include <cerrno>
#include <functional>
#include <map>
#include <string>

using namespace puckloop;
using namespace puckloop::linuxboard;
using cosim::kMillisecond;
using cosim::kNever;
using cosim::kSecond;
using cosim::Time;
using protocols::TcpSegment;
using State = TcpConnection::State;

namespace {

constexpr Endpoint kClientEnd{0x0a000001, 40'000}, kServerEnd{0x0a000002, 7000};

std::string text_of(std::size_t size) {
    std::string text(size, '\0');
    for (std::size_t i = 0; i < size; ++i)
        text[i] = static_cast<char>(i * 7 + (i >> 8));
    return text;
}

/// Client, server and the line between them.
class Line {
  public:
    explicit Line(TcpConnection::Settings server = {}, std::uint32_t first = 0xffffff00)
        : client(kClientEnd, kServerEnd, first, {}), server_settings_(server) {}

    TcpConnection client;
    std::optional<TcpConnection> server;
    /// Delays of the copies that arrive; empty: it is lost. `index` counts the segments of both sides.
    std::function<std::vector<Time>(const TcpSegment&, bool to_server, std::uint64_t index)> line =
        [](const TcpSegment&, bool, std::uint64_t) { return std::vector<Time>{kMillisecond}; };
    Time now = 0;
    std::uint64_t segments = 0;

    void open() {
        client.connect(now);
        run([&] { return server && client.state() == State::Established && server->synchronised(); });
    }
    /// Until `done`, or nothing is left to happen before `limit`.
    bool run(const std::function<bool()>& done, Time limit = 1000 * kSecond) {
        while (true) {
            if (done()) return true;
            collect(client, true);
            if (server) collect(*server, false);
            Time next = std::min(client.next_event(), server ? server->next_event() : kNever);
            if (!flying_.empty()) next = std::min(next, flying_.begin()->first.first);
            if (next == kNever || next > limit) return done();
            now = std::max(now, next);
            while (!flying_.empty() && flying_.begin()->first.first <= now) {
                const auto [segment, to_server] = flying_.begin()->second;
                flying_.erase(flying_.begin());
                arrive(segment, to_server);
            }
            if (client.next_event() <= now) client.advance(now);
            if (server && server->next_event() <= now) server->advance(now);
        }
    }
    void pass(Time duration) {
        const Time end = now + duration;
        run([] { return false; }, end);
        now = end;
    }

  private:
    void collect(TcpConnection& from, bool to_server) {
        for (const TcpSegment& segment : from.take_segments())
            for (const Time delay : line(segment, to_server, segments++))
                flying_.emplace(std::pair(now + delay, order_++), std::pair(segment, to_server));
    }
    void arrive(const TcpSegment& segment, bool to_server) {
        if (!to_server) return client.receive(segment, now);
        if (!server && (segment.flags & protocols::kSyn) != 0) {
            server.emplace(kServerEnd, kClientEnd, 0xfffffff0, server_settings_);
            server->answer(segment, now);
        } else if (server) {
            server->receive(segment, now);
        }
    }
    TcpConnection::Settings server_settings_;
    std::map<std::pair<Time, std::uint64_t>, std::pair<TcpSegment, bool>> flying_;
    std::uint64_t order_ = 0;
};

/// All of `text` from the client to the server, then the end; what arrived.
std::string transfer(Line& line, const std::string& text, Time limit = 10'000 * kSecond) {
    std::string arrived;
    std::size_t written = 0;
    line.run(
        [&] {
            if (written < text.size())
                written += line.client.write(std::string_view(text).substr(written), line.now);
            if (written == text.size() && !line.client.write_done()) line.client.shut_write(line.now);
            if (line.server) arrived += line.server->read(100'000, false, line.now);
            return line.server && line.server->at_end();
        },
        limit);
    return arrived;
}

}  // namespace

TEST_CASE("a connection opens in one round trip, carries data and closes from both sides", "[tcp]") {
    Line line;
    line.open();
    CHECK(line.now == 2 * kMillisecond + kMillisecond);  // the server's, half a round trip later
    const std::string text = text_of(100'000);
    CHECK((transfer(line, text) == text));
    CHECK(line.client.counts().retransmitted == 0);
    // Half closed: the other way is open.
    CHECK(line.server->write("goodbye", line.now) == 7);
    line.server->close(line.now);
    CHECK(line.run([&] { return line.client.at_end() || line.client.readable() == 7; }));
    line.pass(kSecond);
    CHECK(line.client.read(100, false, line.now) == "goodbye");
    CHECK(line.client.at_end());
    CHECK(line.server->state() == State::Closed);
    CHECK(line.client.state() == State::TimeWait);
    line.pass(61 * kSecond);
    CHECK(line.client.state() == State::Closed);
}

TEST_CASE("what a bad line does is not seen by programs", "[tcp]") {
    const std::string text = text_of(200'000);
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        RandomStream random(Catch::rngSeed() + seed, "tcp line");
        Line line({.receive_buffer = seed % 3 == 0 ? 3000u : 65'535u});
        line.line = [&](const TcpSegment&, bool, std::uint64_t) {
            std::vector<Time> copies;
            if (random.uniform() >= 0.05) copies.push_back(kMillisecond);
            if (random.uniform() < 0.05) copies.push_back(3 * kMillisecond);
            if (random.uniform() < 0.05 && !copies.empty()) copies[0] += 7 * kMillisecond;
            return copies;
        };
        line.client.connect(0);
        INFO("seed " << seed);
        CHECK((transfer(line, text) == text));
        CHECK(line.client.counts().retransmitted > 0);
        CHECK(line.server->counts().octets_received == text.size());
    }
}

TEST_CASE("one lost segment of many is sent again by three duplicates, without a time-out", "[tcp]") {
    Line line;
    line.open();
    std::uint64_t data = 0;
    line.line = [&](const TcpSegment& segment, bool to_server, std::uint64_t) {
        const bool lost = to_server && !segment.data.empty() && ++data == 6;
        return lost ? std::vector<Time>{} : std::vector<Time>{kMillisecond};
    };
    const std::string text = text_of(60'000);
    CHECK((transfer(line, text) == text));
    CHECK(line.client.counts().fast_retransmits == 1);
    CHECK(line.client.counts().retransmitted == 1);
    CHECK(line.client.counts().timeouts == 0);
    CHECK(line.now < 200 * kMillisecond);
}

TEST_CASE("a lost SYN is repeated after 1, 2 and 4 s, and given up after 127 s", "[tcp]") {
    Line line;
    std::vector<Time> sent;
    line.line = [&](const TcpSegment&, bool, std::uint64_t) {
        sent.push_back(line.now);
        return std::vector<Time>{};
    };
    line.client.connect(0);
    line.run([&] { return line.client.state() == State::Closed; });
    CHECK(sent ==
          std::vector<Time>{0, kSecond, 3 * kSecond, 7 * kSecond, 15 * kSecond, 31 * kSecond, 63 * kSecond});
    CHECK(line.now == 127 * kSecond);
    CHECK(line.client.take_error() == ETIMEDOUT);
}

TEST_CASE("the time-out of a lost tail is at least 200 ms, and doubles", "[tcp]") {
    Line line;
    line.open();
    std::vector<Time> sent;
    line.line = [&](const TcpSegment& segment, bool to_server, std::uint64_t) {
        if (to_server && !segment.data.empty()) sent.push_back(line.now);
        return std::vector<Time>{};
    };
    const Time begin = line.now;
    line.client.write("x", line.now);
    line.pass(3 * kSecond);
    REQUIRE(sent.size() == 4);
    CHECK(sent[1] - begin >= 200 * kMillisecond);
    CHECK(sent[1] - begin <= 210 * kMillisecond);
    CHECK(sent[2] - sent[1] == 2 * (sent[1] - begin));
    CHECK(sent[3] - sent[2] == 4 * (sent[1] - begin));
}

TEST_CASE("a reader that does not read stops the writer, and lets it go on", "[tcp]") {
    Line line({.receive_buffer = 5000});
    line.open();
    const std::string text = text_of(50'000);
    CHECK(line.client.write(text, line.now) == text.size());
    line.pass(10 * kSecond);
    CHECK(line.server->readable() <= 5000);
    CHECK(line.server->readable() > 5000 - TcpConnection::kSegment);
    // The word that there is room again is lost: the writer asks.
    bool lose = true;
    line.line = [&](const TcpSegment&, bool to_server, std::uint64_t) {
        if (to_server || !std::exchange(lose, false)) return std::vector<Time>{kMillisecond};
        return std::vector<Time>{};
    };
    std::string arrived;
    line.run([&] {
        arrived += line.server->read(100'000, false, line.now);
        return arrived.size() == text.size();
    });
    CHECK((arrived == text));
}

TEST_CASE("Nagle holds small pieces back, TCP_NODELAY does not", "[tcp]") {
    for (const bool no_delay : {false, true}) {
        Line line;
        line.client.settings().no_delay = no_delay;
        line.open();
        std::size_t pieces = 0;
        line.line = [&](const TcpSegment& segment, bool to_server, std::uint64_t) {
            pieces += to_server && !segment.data.empty() ? 1 : 0;
            return std::vector<Time>{kMillisecond};
        };
        for (int i = 0; i < 10; ++i)
            line.client.write("ab", line.now);
        line.pass(kSecond);
        CHECK(line.server->readable() == 20);
        CHECK(pieces == (no_delay ? 10 : 2));
    }
}

namespace {
/// A client that watches its peer: probes after 10 s of silence, each 3 s, four of them.
TcpConnection::Settings watchful() {
    return {.keep_alive = true, .keep_idle = 10 * kSecond, .keep_interval = 3 * kSecond, .keep_count = 4};
}
}  // namespace

TEST_CASE("a peer that is silent is probed, and stays as long as it answers", "[tcp]") {
    Line line;
    line.client.settings() = watchful();
    line.open();
    std::vector<Time> probes;
    line.line = [&](const TcpSegment& segment, bool to_server, std::uint64_t) {
        if (to_server) {
            CHECK(segment.data.empty());
            CHECK(segment.flags == protocols::kAck);
            probes.push_back(line.now);
        }
        return std::vector<Time>{kMillisecond};
    };
    const Time opened = 2 * kMillisecond;  // the client's last segment came then
    line.pass(35 * kSecond);
    // An answer comes 2 ms after its probe, and the wait begins again.
    CHECK(probes == std::vector<Time>{opened + 10 * kSecond, opened + 20 * kSecond + 2 * kMillisecond,
                                      opened + 30 * kSecond + 4 * kMillisecond});
    CHECK(line.client.state() == State::Established);
    CHECK(line.server->state() == State::Established);
}

TEST_CASE("a peer that answers no probe is given up", "[tcp]") {
    const Time begin = 2 * kMillisecond + 10 * kSecond;
    for (const Time patience : {Time{0}, 14 * kSecond}) {
        Line line;
        line.client.settings() = watchful();
        line.client.settings().user_timeout = patience;
        line.open();
        std::vector<std::pair<Time, int>> sent;
        line.line = [&](const TcpSegment& segment, bool to_server, std::uint64_t) {
            if (to_server) sent.emplace_back(line.now - begin, segment.flags);
            return std::vector<Time>{};
        };
        line.pass(100 * kSecond);
        CHECK(line.client.state() == State::Closed);
        CHECK(line.client.take_error() == ETIMEDOUT);
        const auto kProbe = protocols::kAck, kReset = static_cast<protocols::Octet>(protocols::kRst | kProbe);
        // With TCP_USER_TIMEOUT it counts, not the number of probes.
        const auto expected = patience == 0 ? std::vector<std::pair<Time, int>>{{0, kProbe},
                                                                                {3 * kSecond, kProbe},
                                                                                {6 * kSecond, kProbe},
                                                                                {9 * kSecond, kProbe},
                                                                                {12 * kSecond, kReset}}
                                            : std::vector<std::pair<Time, int>>{
                                                  {0, kProbe}, {3 * kSecond, kProbe}, {6 * kSecond, kReset}};
        CHECK(sent == expected);
    }
}

TEST_CASE("keep-alive may be switched on and off while a connection is open", "[tcp]") {
    Line line;
    line.open();
    line.pass(20 * kSecond);
    std::size_t segments = 0;
    line.line = [&](const TcpSegment&, bool, std::uint64_t) {
        ++segments;
        return std::vector<Time>{kMillisecond};
    };
    line.client.settings() = watchful();
    line.client.watch_peer(line.now);
    line.pass(kSecond);  // silent for longer already
    CHECK(segments == 2);
    line.client.settings().keep_alive = false;
    line.client.watch_peer(line.now);
    line.pass(100 * kSecond);
    CHECK(segments == 2);
    CHECK(line.client.next_event() == kNever);
}

TEST_CASE("what is not acknowledged in time ends a connection: TCP_USER_TIMEOUT", "[tcp]") {
    Line line;
    line.open();
    line.client.settings().user_timeout = 1500 * kMillisecond;
    line.line = [](const TcpSegment&, bool, std::uint64_t) { return std::vector<Time>{}; };
    const Time begin = line.now;
    line.client.write("x", line.now);
    line.run([&] { return line.client.state() == State::Closed; });
    CHECK(line.now - begin == 1500 * kMillisecond);
    CHECK(line.client.take_error() == ETIMEDOUT);
}

TEST_CASE("a peer without room is asked as long as it answers, or TCP_USER_TIMEOUT lets it", "[tcp]") {
    for (const Time patience : {Time{0}, 40 * kSecond}) {
        Line line({.receive_buffer = 5000});
        line.client.settings().user_timeout = patience;
        line.open();
        line.client.write(text_of(50'000), line.now);
        line.pass(4000 * kSecond);  // more than 15 probes
        CHECK((line.client.state() == State::Closed) == (patience > 0));
        CHECK(line.client.take_error() == (patience > 0 ? ETIMEDOUT : 0));
    }
}

TEST_CASE("a reset ends both, and what was read is not lost", "[tcp]") {
    Line line;
    line.open();
    line.client.write("last words", line.now);
    line.pass(100 * kMillisecond);
    line.client.abort(line.now);
    line.pass(100 * kMillisecond);
    CHECK(line.server->state() == State::Closed);
    CHECK(line.server->error() == ECONNRESET);
    CHECK(line.server->read(100, false, line.now) == "last words");
}

TEST_CASE("closing with unread data resets", "[tcp]") {
    Line line;
    line.open();
    line.client.write("nobody reads this", line.now);
    line.pass(100 * kMillisecond);
    line.server->close(line.now);
    line.pass(100 * kMillisecond);
    CHECK(line.client.error() == ECONNRESET);
}

TEST_CASE("steady loss gives about the throughput of the square-root law", "[tcp]") {
    // Mathis et al. 1997: segment / round trip x C / sqrt(p), C = sqrt(3/4) with delayed acknowledgements.
    // Every n-th segment is lost, so that no time-out comes between; within a factor that the law allows.
    constexpr Time kWay = 50 * kMillisecond;
    constexpr int kEach = 400;
    Line line;
    line.open();
    std::uint64_t data = 0;
    line.line = [&](const TcpSegment& segment, bool to_server, std::uint64_t) {
        const bool lost = to_server && !segment.data.empty() && ++data % kEach == 0;
        return lost ? std::vector<Time>{} : std::vector<Time>{kWay};
    };
    const std::string text = text_of(6'000'000);
    const Time begin = line.now;
    CHECK((transfer(line, text) == text));
    const double seconds = cosim::to_seconds(line.now - begin);
    const double rate = static_cast<double>(text.size()) / seconds;
    const double law = TcpConnection::kSegment / 0.1 * std::sqrt(0.75 * kEach);
    INFO("rate " << rate << " octets/s, law " << law);
    CHECK(line.client.counts().timeouts == 0);
    CHECK(rate > 0.8 * law);
    CHECK(rate < 1.6 * law);  // each acknowledgement of two segments counts once here too, see RFC 5681
}
