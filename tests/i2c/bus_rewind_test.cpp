// A bus that ran ahead and went back is the bus that never did: what it sends, EOTs, logs and reports.
// Two masters, one of them a device too, a board behind a port, ground sensor and turret, all at random; a
// twin is never marked.

#include "base/random.h"
#include "bus_outside.h"
#include "cosim/i2c/i2c_bus.h"
#include "tests/kit/files.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tests;

namespace {

bool same_future(const Node& a, const Node& b) {
    for (PortIndex port = 0; port <= kWorld; ++port)
        if (a.earliest_output(port) != b.earliest_output(port) || a.lookahead(port) != b.lookahead(port))
            return false;
    return true;
}

}  // namespace

TEST_CASE("a bus goes back") {
    int stops = 0;
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
        stops += outside.stops_seen;
        const std::string report = node->finish();
        CHECK(report == twin->finish());
        CHECK(report.find("\"transfers\":0") == std::string::npos);
        CHECK(text_of(log) == text_of(twin_log));
        std::remove(log.c_str());
        std::remove(twin_log.c_str());
    }
    CHECK(stops > 60);
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
