// The bus as a node: what controllers send and get, its promises to the conductor, what it reports.

#include "base/json.h"
#include "cosim/can/can_bus.h"
#include "cosim/can/can_message.h"
#include "tests/can/wire_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::cosim;
using tests::kBit;

namespace {

CanMessage joining(Time bit = kBit, bool listens = false) {
    CanMessage message;
    message.kind = CanKind::Join;
    message.bit_time = static_cast<std::uint32_t>(bit);
    message.data = {16, 12, 2};
    if (listens) message.flags = kCanListens;
    return message;
}

CanMessage offering(const protocols::CanFrame& frame, std::uint8_t tag = 0) {
    CanMessage message;
    message.kind = CanKind::Offer;
    message.tag = tag;
    put_frame(message, frame);
    return message;
}

CanMessage plain(CanKind kind, std::uint8_t tag = 0) {
    CanMessage message;
    message.kind = kind;
    message.tag = tag;
    return message;
}

CanBusOptions three(std::vector<CarriedFault> faults = {}) {
    return {"can", {"a", "b", "c"}, "", std::move(faults)};
}

/// Advances the bus to `end`, cut at random, and holds it to what it promised before each advance.
std::vector<Message> run(CanBusNode& bus, const std::vector<Message>& inbox, Time end, RandomStream& random) {
    std::vector<Message> out;
    std::size_t next = 0;
    for (Time now = 0; now < end;) {
        const Time most = random.below(4) == 0 ? 300 * kBit : 20 * kBit;
        const Time until =
            std::min(end, now + 1 + static_cast<Time>(random.below(static_cast<std::uint64_t>(most))));
        std::vector<Time> promised;
        for (PortIndex port = 0; port < 3; ++port) {
            promised.push_back(bus.earliest_output(port));
            // Else neither the bus nor those who wait for it could ever go on.
            CHECK(promised.back() > now);
        }
        const std::size_t first = next;
        while (next < inbox.size() && inbox[next].time < until)
            ++next;
        const std::size_t before = out.size();
        bus.advance(until, std::span(inbox).subspan(first, next - first), out);
        const Time came = first < next ? inbox[first].time : kNever;
        for (std::size_t i = before; i < out.size(); ++i)
            CHECK(out[i].time >= std::min(promised[out[i].port], later(came, bus.lookahead(out[i].port))));
        for (std::size_t i = before + 1; i < out.size(); ++i)
            for (std::size_t k = before; k < i; ++k)
                if (out[k].port == out[i].port) CHECK(out[k].time <= out[i].time);
        now = until;
    }
    return out;
}

}  // namespace

TEST_CASE("what a CAN bus sends does not depend on how it is advanced, and keeps its earliest output times") {
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
        CAPTURE(seed);
        RandomStream random(seed, "bus");
        std::vector<Message> inbox;
        const Time end = 20'000 * kBit;
        for (PortIndex port = 0; port < 3; ++port) {
            const Time bit =
                random.below(6) == 0 ? kBit / 2 + static_cast<Time>(random.below(2 * kBit)) : kBit;
            inbox.push_back(
                {static_cast<Time>(random.below(30 * kBit)), port, joining(bit, random.below(8) == 0)});
        }
        for (int i = 0; i < 60; ++i) {
            const Time time = 20 * kBit + static_cast<Time>(random.below(static_cast<std::uint64_t>(end)));
            const auto port = static_cast<PortIndex>(random.below(3));
            const auto tag = static_cast<std::uint8_t>(random.below(3));
            CanMessage message = offering(tests::draw_frame(random), tag);
            switch (random.below(12)) {
            case 0:
                message = plain(CanKind::Withdraw, tag);
                break;
            case 1:
                message = plain(CanKind::Leave);
                break;
            case 2:
                message = plain(CanKind::Watch);
                break;
            case 3:
            case 4:
                message = joining();
                break;
            default:
                break;
            }
            inbox.push_back({time, port, message});
        }
        std::stable_sort(inbox.begin(), inbox.end(),
                         [](const Message& a, const Message& b) { return a.time < b.time; });
        std::vector<CarriedFault> faults;
        if (seed % 3 == 0) {
            FaultSpec spec;
            spec.link = spec.node = "can";
            spec.kind = "flip";
            spec.probability = 0.3;
            faults.push_back(tests::fault_of(spec));
            spec.kind = seed % 2 == 0 ? "stuck" : "disconnect";
            spec.probability = 1;
            spec.begin = 5000 * kBit;
            spec.end = 6000 * kBit;
            faults.push_back(tests::fault_of(spec, 1));
        }
        CanBusNode bus(three(faults)), again(three(faults));
        RandomStream other(seed + 1000, "bus");
        const std::vector<Message> one = run(bus, inbox, end, random);
        CHECK(one == run(again, inbox, end, other));
        CHECK(one.size() > 10);
        CHECK(bus.finish() == again.finish());
    }
}

TEST_CASE("a frame crosses the bus, its sender and the others hear of it at the same instant") {
    RandomStream random(1, "bus");
    CanBusNode bus(three());
    const protocols::CanFrame frame{.id = 0x321, .length = 3, .data = {1, 2, 3}};
    const std::vector<Message> inbox{{0, 0, joining()},
                                     {0, 1, joining()},
                                     {0, 2, joining(kBit, true)},
                                     {50 * kBit, 0, offering(frame, 2)}};
    const auto out = run(bus, inbox, 200 * kBit, random);
    REQUIRE(out.size() == 3);
    for (const Message& message : out) {
        const auto& told = std::get<CanMessage>(message.payload);
        CHECK(message.time == (50 + tests::reference_bits(frame)) * kBit);
        CHECK(told.start == 50 * kBit);
        CHECK(frame_in(told) == frame);
        CHECK(told.kind == (message.port == 0 ? CanKind::Sent : CanKind::Received));
        if (message.port == 0) CHECK(told.tag == 2);
    }
}

TEST_CASE("a wire held dominant while no controller takes part: the evidence states it once") {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        CAPTURE(seed);
        RandomStream random(seed, "bus");
        const Time begin = (1 + static_cast<Time>(random.below(100))) * kBit;
        std::vector<CarriedFault> faults;
        for (const Time from : {begin, 500 * kBit}) {
            FaultSpec spec;
            spec.link = spec.node = "can";
            spec.kind = "stuck";
            spec.set("level", std::string("dominant"));
            spec.begin = from;
            spec.end = from + 50 * kBit;
            faults.push_back(tests::fault_of(spec, static_cast<int>(faults.size())));
        }
        CanBusNode bus(three(faults));
        CHECK(run(bus, {}, 400 * kBit, random).empty());
        const auto found = nlohmann::json::parse(bus.finish()).at("faults");
        CHECK(found[0]["fired"] == 1);
        CHECK(found[0]["firings"][0][0] == begin);
        CHECK(found[0]["firings"][0].back() == "the wire is dominant and no controller takes part");
        CHECK(found[1]["fired"] == 0);
    }
}

TEST_CASE("a frame that comes too late is sent behind, one withdrawn is not, the watcher is woken") {
    RandomStream random(2, "bus");
    CanBusNode bus(three());
    const protocols::CanFrame low{.id = 1}, high{.id = 2}, never{.id = 3};
    const Time length = tests::reference_bits(high) * kBit;
    const std::vector<Message> inbox{{0, 0, joining()},
                                     {0, 1, joining()},
                                     {0, 2, plain(CanKind::Watch)},
                                     {50 * kBit, 0, offering(high)},
                                     {51 * kBit, 1, offering(never, 1)},
                                     {52 * kBit, 1, plain(CanKind::Withdraw, 1)},
                                     {60 * kBit, 1, offering(low)}};
    const auto out = run(bus, inbox, 400 * kBit, random);
    std::vector<std::pair<Time, CanKind>> of_b, of_c;
    for (const Message& message : out) {
        const CanKind kind = std::get<CanMessage>(message.payload).kind;
        if (message.port == 1) of_b.emplace_back(message.time, kind);
        if (message.port == 2) of_c.emplace_back(message.time, kind);
    }
    const Time behind = 50 * kBit + length + 3 * kBit;
    CHECK(of_b ==
          std::vector<std::pair<Time, CanKind>>{{52 * kBit + CanBusNode::kLookahead, CanKind::Withdrawn},
                                                {50 * kBit + length, CanKind::Received},
                                                {behind + tests::reference_bits(low) * kBit, CanKind::Sent}});
    REQUIRE_FALSE(of_c.empty());
    CHECK(of_c[0] == std::pair{50 * kBit + CanBusNode::kLookahead, CanKind::Wake});
}

TEST_CASE("a frame that a fault keeps from a program is acknowledged, and counted") {
    RandomStream random(3, "bus");
    FaultSpec spec;
    spec.link = spec.node = "can";
    spec.kind = "drop";
    spec.set("to", "b");
    spec.count = 1;
    CanBusNode bus(three({tests::fault_of(spec)}));
    const protocols::CanFrame frame{.id = 7, .length = 1};
    std::vector<Message> inbox{{0, 0, joining()}, {0, 1, joining()}, {0, 2, joining()}};
    for (const int at : {50, 200})
        inbox.push_back({at * kBit, 0, offering(frame)});
    const auto out = run(bus, inbox, 500 * kBit, random);
    std::vector<int> per_port(3, 0);
    for (const Message& message : out)
        ++per_port[message.port];
    CHECK(per_port == std::vector<int>{2, 1, 2});
    const auto report = nlohmann::json::parse(bus.finish());
    CHECK(report["frames"] == 2);
    CHECK(report["controllers"]["a"]["sent"] == 2);
    CHECK(report["controllers"]["b"]["received"] == 1);
    CHECK(report["faults"][0]["fired"] == 1);
}

TEST_CASE("the report names who is set to another bit rate and whom nobody acknowledged") {
    RandomStream random(4, "bus");
    CanBusNode bus(three());
    const std::vector<Message> inbox{
        {0, 0, joining()}, {0, 1, joining(2 * kBit)}, {100 * kBit, 0, offering({.id = 5})}};
    run(bus, inbox, 5000 * kBit, random);
    const std::string text = bus.finish();
    CHECK_THAT(text, Catch::Contains("b is set to 500 kbit/s, a to 1000: they cannot read each other"));
    CanBusNode alone(three());
    run(alone, {{0, 0, joining()}, {100 * kBit, 0, offering({.id = 5})}}, 1000 * kBit, random);
    CHECK_THAT(alone.finish(), Catch::Contains("nobody acknowledged it"));
}
