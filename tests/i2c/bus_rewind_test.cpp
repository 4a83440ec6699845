// A bus that ran ahead and went back is the bus that never did: what it sends, EOTs, logs and reports.
// Two masters, one of them a device too, a board behind a port, ground sensor and turret, all at random; a
// twin is never marked.

#include "base/random.h"
#include "cosim/i2c/i2c_bus.h"
#include "emu/i2c_devices/bus_node.h"
#include "tests/scratch.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <fstream>
#include <sstream>

using namespace puckloop;
using namespace puckloop::cosim;

namespace {

constexpr PortIndex kMasters = 2, kMainBoard = 3, kWorld = 4;
constexpr Time kPeriod = 10 * kMicrosecond;

/// Masters, board and world: what each does next follows from what the bus sent.
class Outside {
  public:
    explicit Outside(std::uint64_t seed) : random_(seed, "outside") {
        for (PortIndex master = 0; master < kMasters; ++master)
            begin(master, pick(200 * kMicrosecond));
    }

    /// The messages before `until`, in order of time.
    std::vector<Message> before(Time until) {
        std::stable_sort(coming_.begin(), coming_.end(),
                         [](const Message& a, const Message& b) { return a.time < b.time; });
        const auto end = std::find_if(coming_.begin(), coming_.end(),
                                      [until](const Message& message) { return message.time >= until; });
        std::vector<Message> inbox(coming_.begin(), end);
        coming_.erase(coming_.begin(), end);
        return inbox;
    }
    void react(const std::vector<Message>& sent, Time now) {
        for (const Message& message : sent) {
            const auto* phase = std::get_if<I2cPhase>(&message.payload);
            if (phase == nullptr) continue;
            const Time at = std::max(message.time, now);
            if (message.port < kMasters)
                go_on(message.port, *phase, at);
            else
                board(message.port, *phase, at);
        }
        if (random_.below(4) == 0)
            coming_.push_back({now + pick(kMillisecond), kWorld,
                               Signal{static_cast<std::uint16_t>(random_.below(6)),
                                      static_cast<double>(random_.below(1000))}});
    }

    int stops_seen = 0;  ///< by the device that is a master too

  private:
    Time pick(Time most) { return 1 + static_cast<Time>(random_.below(static_cast<std::uint64_t>(most))); }
    void send(PortIndex port, I2cPhaseKind kind, std::uint8_t byte, Time at) {
        I2cPhase phase{.kind = kind,
                       .byte = byte,
                       .ack = kind != I2cPhaseKind::Acknowledge,
                       .start = at,
                       .clock_period = kPeriod};
        coming_.push_back({at, port, phase});
    }
    void begin(PortIndex master, Time at) {
        constexpr std::uint8_t kAddresses[] = {0x60, 0x61, 0x20, 0x33};
        const auto address = kAddresses[random_.below(4)];
        send(master, I2cPhaseKind::Start, static_cast<std::uint8_t>(address << 1 | random_.below(2)), at);
    }
    void go_on(PortIndex master, const I2cPhase& answer, Time now) {
        const Time at = now + (random_.below(2) == 0 ? 1 : pick(50 * kMicrosecond));
        const bool refused = answer.kind == I2cPhaseKind::BusLost || answer.ack == 0;
        const std::uint64_t what = random_.below(refused ? 2 : 12);
        if (what < 2) {
            if (answer.kind != I2cPhaseKind::BusLost) send(master, I2cPhaseKind::Stop, 0, at);
            begin(master, at + pick(500 * kMicrosecond));
        } else if (what == 2) {
            begin(master, at);
        } else if (answer.kind == I2cPhaseKind::Data && what == 4) {  // and goes on, against a NACK
            send(master, I2cPhaseKind::Acknowledge, 0, at);
            send(master, I2cPhaseKind::Write, 0xA5, at + 1);
        } else if (answer.kind == I2cPhaseKind::Data || what == 3) {
            send(master, I2cPhaseKind::Read, 0, at);
        } else {
            send(master, I2cPhaseKind::Write, static_cast<std::uint8_t>(random_.below(256)), at);
        }
        if (random_.below(25) == 0) {  // loses patience
            send(master, I2cPhaseKind::Stop, 0, at + pick(kMillisecond));
            begin(master, at + kMillisecond + pick(kMillisecond));
        }
    }
    void board(PortIndex port, const I2cPhase& phase, Time now) {
        stops_seen += port == kMainBoard && phase.kind == I2cPhaseKind::Stop;
        if (phase.kind == I2cPhaseKind::Stop || phase.kind == I2cPhaseKind::Acknowledge) return;
        I2cPhase answer = phase;
        answer.kind = phase.kind == I2cPhaseKind::Read ? I2cPhaseKind::Data : I2cPhaseKind::Acknowledge;
        answer.ack = random_.below(5) != 0;
        answer.byte = static_cast<std::uint8_t>(random_.below(256));
        const Time stretch = random_.below(6) == 0 ? pick(2 * kMillisecond) : 0;
        coming_.push_back({std::max(now, phase.start + 8 * kPeriod + stretch), port, answer});
    }

    RandomStream random_;
    std::vector<Message> coming_;
};

std::unique_ptr<Node> bus(const std::string& log) {
    i2c_devices::BusSpec spec;
    spec.boards = {{"rab", {}}, {.name = "main_board", .main_board = true}};
    spec.log = log;
    return i2c_devices::make_bus_node(spec);
}

std::string text_of(const std::string& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
}

bool same_future(const Node& a, const Node& b) {
    for (PortIndex port = 0; port <= kWorld; ++port)
        if (a.earliest_output(port) != b.earliest_output(port) || a.lookahead(port) != b.lookahead(port))
            return false;
    return true;
}

}  // namespace

TEST_CASE("a bus goes back") {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        INFO("seed " << seed);
        RandomStream random(seed, "marks");
        const std::string log = tests::scratch_path("bus.log").string();
        const std::string twin_log = tests::scratch_path("twin.log").string();
        const auto node = bus(log), twin = bus(twin_log);
        REQUIRE(node->rewindable() != nullptr);
        Rewindable& back = *node->rewindable();
        Outside outside(seed);
        const auto longest = [&] { return Time{1} + static_cast<Time>(random.below(500'000'000)); };
        Time now = 0;
        for (int i = 0; i < 400; ++i) {
            back.mark();
            const std::string text = text_of(log);
            for (std::uint64_t times = random.below(3); times > 0; --times) {
                Outside other = outside;
                Time ahead = now;
                for (std::uint64_t steps = 1 + random.below(4); steps > 0; --steps) {
                    ahead += longest();
                    std::vector<Message> sent;
                    node->advance(ahead, other.before(ahead), sent);
                    other.react(sent, ahead);
                    if (random.below(3) == 0) other = Outside(random.next());
                    other.before(ahead);  // late ones of the new outside
                }
                CHECK(text_of(log) == text);
                back.rewind();
                REQUIRE(same_future(*node, *twin));
            }
            if (random.below(2) == 0) back.settle();
            now += longest();
            const std::vector<Message> inbox = outside.before(now);
            std::vector<Message> sent, expected;
            node->advance(now, inbox, sent);
            twin->advance(now, inbox, expected);
            REQUIRE((sent == expected));
            REQUIRE(same_future(*node, *twin));
            outside.react(expected, now);
        }
        if (seed % 2 == 0) {
            back.settle();
            CHECK(text_of(log) == text_of(twin_log));
        }
        CHECK(outside.stops_seen > 5);
        const std::string report = node->finish();
        CHECK(report == twin->finish());
        CHECK(report.find("\"transfers\":0") == std::string::npos);
        CHECK(text_of(log) == text_of(twin_log));
        std::remove(log.c_str());
        std::remove(twin_log.c_str());
    }
}

TEST_CASE("a bus with a device that cannot go back cannot either") {
    class Stubborn final : public I2cSlave {
      public:
        std::string_view name() const override { return "stubborn"; }
        bool listens_to(std::uint8_t) const override { return false; }
        I2cAnswer start(bool, Time) override { return {}; }
        I2cAnswer write(std::uint8_t, Time) override { return {}; }
        I2cAnswer read(Time) override { return {}; }
    };
    std::vector<std::unique_ptr<I2cSlave>> slaves;
    slaves.push_back(std::make_unique<Stubborn>());
    I2cBusNode node({.masters = {{"pic", false}}}, std::move(slaves));
    CHECK(node.rewindable() == nullptr);
}
