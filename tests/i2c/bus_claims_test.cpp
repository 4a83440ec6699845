// What a bus that ran ahead claims of its future holds, whatever comes in instead of the foreseen: the
// earliest output time and the lookahead that the conductor's bounds are made of. Drawn.

#include "base/random.h"
#include "bus_outside.h"
#include "cosim/schedule/run_ahead.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tests;

namespace {

constexpr Time kStep = 2 * kMicrosecond;  // less than anything on the bus takes

/// What comes in before `end` where `outside` and `node` act on each other from `from` on.
std::vector<Message> played(Node& node, Outside& outside, Time from, Time end) {
    std::vector<Message> inbox;
    for (Time now = from; now < end;) {
        now = std::min(end, now + kStep);
        const std::vector<Message> due = outside.before(now);
        std::vector<Message> sent;
        node.advance(now, due, sent);
        outside.react(sent, now);
        inbox.insert(inbox.end(), due.begin(), due.end());
    }
    return inbox;
}

Time first_difference(const std::vector<Message>& a, const std::vector<Message>& b) {
    const auto [x, y] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
    return std::min(x == a.end() ? kNever : x->time, y == b.end() ? kNever : y->time);
}

std::vector<Message> on_port(const std::vector<Message>& sent, PortIndex port) {
    std::vector<Message> chosen;
    std::copy_if(sent.begin(), sent.end(), std::back_inserter(chosen),
                 [port](const Message& message) { return message.port == port; });
    return chosen;
}

/// `claimed`: at the port, with `before` foreseen. From `surprise` on something else came in, and `after`
/// out.
void check_claim(const PortState& claimed, const std::vector<Message>& before,
                 const std::vector<Message>& after, Time surprise) {
    const auto [x, y] = std::mismatch(before.begin(), before.end(), after.begin(), after.end());
    if (x != before.end()) CHECK(x->time >= surprise + (claimed.lookahead > 0 ? 1 : 0));
    if (y == after.end()) return;
    // Beyond a message that may change anything may come.
    const auto open = std::find_if(before.begin(), before.end(), [&](const Message& message) {
        return message.time >= surprise + (claimed.lookahead > 0 ? 1 : 0);
    });
    const Time changes = open == before.end() ? kNever : open->time;
    CHECK(y->time >= std::min({claimed.earliest_output, later(surprise, claimed.lookahead), changes}));
}

}  // namespace

TEST_CASE("what a bus that ran ahead claims of its future holds for every other future") {
    int surprises = 0;
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
        RandomStream random(seed, "claims");
        const auto drawn = [&](Time most) {
            return 1 + static_cast<Time>(random.below(static_cast<std::uint64_t>(most)));
        };
        const bool two_boards = seed % 2 == 0;
        const PortIndex world = two_boards ? kWorld : kWorld - 1;
        const auto twin = bus({}, two_boards);
        RunAhead node(bus({}, two_boards));
        std::vector<Message> outbox;
        Outside outside(seed, Outside::Masters::Sane, world);
        Time now = 0;
        for (int i = 0; i < 600; ++i) {
            INFO("seed " << seed << ", turn " << i);
            const Time ahead = now + drawn(300 * kMicrosecond), apart = now + drawn(ahead - now);
            const auto future = [&](std::uint64_t others) {
                Outside copy = outside;
                twin->rewindable()->mark();
                std::vector<Message> inbox = played(*twin, copy, now, apart);
                if (others != 0) copy.diverge(others, apart);
                const std::vector<Message> rest = played(*twin, copy, apart, ahead);
                inbox.insert(inbox.end(), rest.begin(), rest.end());
                twin->rewindable()->rewind();
                return inbox;
            };
            const std::vector<Message> foreseen = future(0), true_one = future(random.next() | 1);
            node.advance({now, now, ahead}, foreseen, {}, outbox);
            const std::vector<Message> before = outbox;
            NodeState state;
            node.read_state(state);
            const Time surprise = first_difference(foreseen, true_one);
            node.advance({now, now, ahead}, true_one, {}, outbox);
            if (surprise < ahead) {
                ++surprises;
                INFO("at " << surprise);
                for (PortIndex port = 0; port <= world; ++port)
                    check_claim(state.ports[port], on_port(before, port), on_port(outbox, port), surprise);
            }
            // On as it was foreseen.
            node.advance({now, now, now}, {}, {}, outbox);
            const std::vector<Message> due = played(*twin, outside, now, ahead);
            node.advance({ahead, ahead, ahead}, due, {}, outbox);
            now = ahead;
        }
    }
    CHECK(surprises > 1000);
}

TEST_CASE("while a board is asked an earlier answer of it is an earlier answer of the bus") {
    RunAhead node(bus({}, false));
    std::vector<Message> outbox;
    const auto at = [](Time time, PortIndex port, I2cPhaseKind kind) {
        return Message{
            time, port,
            I2cPhase{
                .kind = kind, .byte = 0x66, .ack = 1, .start = 10 * kMicrosecond, .clock_period = kPeriod}};
    };
    const Message start = at(10 * kMicrosecond, 1, I2cPhaseKind::Start);
    node.advance({0, 0, 250 * kMicrosecond},
                 std::vector{start, at(200 * kMicrosecond, 2, I2cPhaseKind::Acknowledge)}, {}, outbox);
    NodeState state;
    node.read_state(state);
    CHECK(outbox.size() == 2);
    CHECK(state.ports[1].lookahead == kPeriod);
    node.advance({0, 0, 250 * kMicrosecond},
                 std::vector{start, at(150 * kMicrosecond, 2, I2cPhaseKind::Acknowledge)}, {}, outbox);
    REQUIRE(outbox.size() == 2);
    CHECK(outbox[1].time == 160 * kMicrosecond);
}
