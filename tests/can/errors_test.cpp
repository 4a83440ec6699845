// Error frames and error counters of a CAN bus, by CAN 2.0 part B, section 8 (fault confinement).

#include "tests/can/wire_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::tests;
using cosim::FaultSpec;
using protocols::CanError;
using What = CanNews::What;

namespace {

const CanFrame kFrame{.id = 0x123, .length = 2, .data = {0x55, 0xAA}};

FaultSpec flip(int bit, const char* to = "") {
    FaultSpec spec;
    spec.link = spec.node = "can";
    spec.kind = "flip";
    spec.count = 1;
    spec.set("bit", bit);
    if (*to != '\0') spec.set("to", to);
    return spec;
}

FaultSpec holding(const char* kind, Time begin, Time end) {
    FaultSpec spec;
    spec.link = spec.node = "can";
    spec.kind = kind;
    spec.begin = begin;
    spec.end = end;
    return spec;
}

}  // namespace

TEST_CASE("alone on the bus: 16 tries to error passive, then for ever at 128, with suspension") {
    WireBench bench(1);
    bench.join_all();
    bench.wishes[0].push_back({100 * kBit, kFrame});
    bench.run(10'000 * kBit);
    const std::vector<Told> errors = bench.of(0, What::Error);
    REQUIRE(errors.size() > 40);
    // Noticed in the acknowledge slot: flag, delimiter, intermission; passive, 8 more bits.
    const int to_slot = reference_bits(kFrame) - 8;
    for (std::size_t i = 0; i < 40; ++i) {
        CAPTURE(i);
        CHECK(errors[i].news.error == CanError::Acknowledge);
        CHECK(errors[i].news.sender);
        CHECK(errors[i].news.position == to_slot - 1);
        CHECK(errors[i].tec == std::min<unsigned>(8 * (static_cast<unsigned>(i) + 1), 128));
        CHECK(errors[i].time - errors[i].news.start == (to_slot + 6 + 8) * kBit);
        const Time gap = errors[i + 1].news.start - errors[i].time;
        CHECK(gap == (i + 1 < 16 ? 3 : 3 + 8) * kBit);
    }
    // Somebody comes: the frame is through, and the counter falls by one.
    bench.wire.set(0, {true, kTiming}, 10'000 * kBit);
}

TEST_CASE("a bit inverted for all: error frame, repeated at once, counters 8 and 1, then 7 and 0") {
    for (int bit = 0; bit < 40; ++bit) {
        CAPTURE(bit);
        WireBench bench(3, {flip(bit)});
        bench.join_all();
        bench.wishes[1].push_back({100 * kBit, kFrame});
        bench.run(400 * kBit);
        const int count = reference_bits(kFrame);
        const std::string text = frame_text(kFrame);
        const int arbitration = can_levels(kFrame).arbitration;
        const int at = std::min(arbitration + 1 + bit, count - 1);
        const auto sent = bench.of(1, What::Sent);
        REQUIRE(sent.size() == 1);
        const auto errors = bench.of(1, What::Error);
        REQUIRE(errors.size() == 1);
        const bool slot = at == count - 9;  // the acknowledge is not heard
        CHECK(errors[0].news.error == (slot ? CanError::Acknowledge : CanError::Bit));
        CHECK(errors[0].news.position == at);
        CHECK(errors[0].tec == 8);
        CHECK(sent[0].tec == 7);
        CHECK(sent[0].news.start > errors[0].time);
        for (const std::size_t receiver : {0u, 2u}) {
            const auto received = bench.of(receiver, What::Received);
            // A frame whose last bit alone is spoilt is taken twice (CAN 2.0, 5: valid for receivers before).
            CHECK(received.size() == (at == count - 1 ? 2u : 1u));
            CHECK(received.back().news.frame == kFrame);
            CHECK(received.back().time == sent[0].time);
            CHECK(received.back().rec == 0);
        }
        CHECK(bench.wire.faults().carried()[0].evidence.fired() == 1);
    }
}

TEST_CASE("one receiver reads a bit wrong: nobody takes the frame, all take the repetition") {
    for (const int bit : {0, 7, 20, 30}) {
        CAPTURE(bit);
        WireBench bench(3, {flip(bit, "s2")});
        bench.join_all();
        bench.wishes[0].push_back({100 * kBit, kFrame});
        bench.run(400 * kBit);
        CHECK(bench.of(0, What::Sent).size() == 1);
        CHECK(bench.of(0, What::Error).size() == 1);
        for (const std::size_t receiver : {1u, 2u}) {
            CHECK(bench.of(receiver, What::Error).size() == 1);
            const auto received = bench.of(receiver, What::Received);
            REQUIRE(received.size() == 1);
            CHECK(received[0].news.frame == kFrame);
        }
        // The one that saw it first finds its flag followed by the others': 1 + 8 (rule 2).
        CHECK(bench.of(2, What::Error)[0].rec >= 1);
    }
}

TEST_CASE("32 frames spoilt in a row are bus-off, for 128 times 11 recessive bits") {
    FaultSpec spec = flip(3);
    spec.count = 32;
    WireBench bench(2, {spec});
    bench.join_all();
    bench.wishes[0].push_back({100 * kBit, kFrame});
    bench.run(20'000 * kBit);
    CHECK(bench.of(0, What::Error).size() == 31);
    const auto off = bench.of(0, What::BusOff);
    REQUIRE(off.size() == 1);
    CHECK(off[0].tec == 256);
    const auto back = bench.of(0, What::Recovered);
    REQUIRE(back.size() == 1);
    CHECK(back[0].tec == 0);
    // The first recessive bit is the one behind the error.
    const Time first = off[0].news.start + (off[0].news.position + 1) * kBit;
    CHECK(back[0].time - first >= 128 * 11 * kBit);
    CHECK(back[0].time - first <= (128 * 11 + 20) * kBit);
    const auto sent = bench.of(0, What::Sent);
    REQUIRE(sent.size() == 1);
    CHECK(sent[0].news.start == back[0].time);
}

TEST_CASE("who listens only acknowledges nothing, sends no flags and receives") {
    WireBench bench(3);
    bench.wire.set(0, {true, kTiming}, 0);
    bench.wire.set(1, {true, kTiming, true}, 0);
    bench.wishes[0].push_back({100 * kBit, kFrame});
    bench.run(300 * kBit);
    CHECK(bench.of(0, What::Sent).empty());
    CHECK(bench.of(0, What::Error).size() >= 2);
    CHECK(bench.of(1, What::Received).empty());
    bench.wire.set(2, {true, kTiming}, 300 * kBit);
    bench.run(600 * kBit);
    CHECK(bench.of(0, What::Sent).size() == 1);
    CHECK(bench.of(1, What::Received).size() == 1);
    CHECK(bench.wire.station(1).receive_errors() == 0);
}

TEST_CASE("two bit rates on a bus: error frames, and nothing is received") {
    for (const Time other : {kBit * 2, kBit / 2, kBit * 11 / 10}) {
        CAPTURE(other);
        WireBench bench(2);
        bench.wire.set(0, {true, kTiming}, 0);
        bench.wire.set(1, {true, {other, other * 3 / 4, other / 8}}, 0);
        bench.wishes[0].push_back({100 * kBit, kFrame});
        bench.run(20'000 * kBit);
        CHECK(bench.of(0, What::Sent).empty());
        CHECK(bench.of(1, What::Received).empty());
        CHECK(bench.of(0, What::Error).size() > 10);
        CHECK(bench.of(1, What::Error).size() > 0);
    }
}

TEST_CASE("crystals 0.4 % apart understand each other by resynchronising, without it they do not") {
    for (const bool jumps : {true, false}) {
        CAPTURE(jumps);
        RandomStream random(5, "crystals");
        WireBench bench(2);
        const auto timing = [&](Time bit) { return CanTiming{bit, bit * 3 / 4, jumps ? bit / 8 : 0}; };
        bench.wire.set(0, {true, timing(kBit)}, 0);
        bench.wire.set(1, {true, timing(kBit + kBit / 250)}, 0);
        for (int i = 0; i < 30; ++i) {
            CanFrame frame = draw_frame(random);
            frame.remote = false;
            frame.length = 8;
            bench.wishes[static_cast<std::size_t>(i % 2)].push_back({(100 + 400 * i) * kBit, frame});
        }
        bench.run(30'000 * kBit);
        const auto errors = bench.of(0, What::Error).size() + bench.of(1, What::Error).size();
        CHECK((errors == 0) == jumps);
        if (jumps) CHECK(bench.of(0, What::Received).size() == 15);
        if (jumps) CHECK(bench.of(1, What::Received).size() == 15);
    }
}

TEST_CASE("a wire held dominant: nobody sends, counters climb, all goes on when it is let go") {
    WireBench bench(2, {holding("stuck", 500 * kBit, 900 * kBit)});
    bench.join_all();
    bench.wishes[0].push_back({100 * kBit, kFrame});
    bench.wishes[0].push_back({600 * kBit, kFrame});
    bench.run(2000 * kBit);
    const auto sent = bench.of(0, What::Sent);
    REQUIRE(sent.size() == 2);
    CHECK(sent[1].news.start > 900 * kBit);
    CHECK(bench.of(1, What::Received).size() == 2);
    CHECK_FALSE(bench.of(0, What::Error).empty());
    CHECK_FALSE(bench.of(1, What::Error).empty());
    CHECK(bench.of(1, What::Error).back().rec > 8);
    CHECK(bench.wire.faults().carried()[0].evidence.fired() == 1);
}

TEST_CASE("a controller cut off hears only itself, the others go on") {
    FaultSpec spec = holding("disconnect", 0, 1000 * kBit);
    spec.from = "s2";
    WireBench bench(3, {spec});
    bench.join_all();
    bench.wishes[0].push_back({100 * kBit, kFrame});
    bench.wishes[2].push_back({100 * kBit, {.id = 1, .length = 1}});
    bench.run(2000 * kBit);
    CHECK(bench.of(0, What::Sent)[0].news.start == 100 * kBit);
    CHECK(bench.of(1, What::Received)[0].news.frame == kFrame);
    CHECK(bench.of(2, What::Received).empty());
    CHECK(bench.of(2, What::Error).size() > 4);
    const auto sent = bench.of(2, What::Sent);
    REQUIRE(sent.size() == 1);
    CHECK(sent[0].news.start > 1000 * kBit);
    CHECK(bench.of(1, What::Received).size() == 2);
    CHECK(bench.wire.faults().carried()[0].evidence.fired() == 1);
}

TEST_CASE("what is withdrawn before it has begun is not sent, what is under way is not repeated") {
    WireBench bench(2, {flip(5)});
    bench.join_all();
    bench.wishes[0].push_back({100 * kBit, kFrame});
    bench.run(110 * kBit);
    CHECK_FALSE(bench.wire.station(0).withdraw());
    bench.wire.station(1).offer({kFrame, can_levels(kFrame), 0}, 110 * kBit);
    CHECK(bench.wire.station(1).withdraw());
    bench.run(500 * kBit);
    CHECK(bench.of(0, What::Sent).empty());
    REQUIRE(bench.of(0, What::Error).size() == 1);
    CHECK(bench.of(0, What::Error)[0].news.gone);
    CHECK(bench.of(1, What::Sent).empty());
}
