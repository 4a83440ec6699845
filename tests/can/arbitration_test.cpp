// Random controllers and frames on a wire, held to a straight model: who is first by the frames' bits as
// text, when by their length.

#include "tests/can/wire_bench.h"

#include "protocols/can/can_reader.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::tests;

namespace {

struct Passage {
    std::size_t station = 0;
    Time start = 0, end = 0;
    CanFrame frame;

    friend bool operator==(const Passage&, const Passage&) = default;
};

std::ostream& operator<<(std::ostream& out, const Passage& passage) {
    return out << passage.station << "@" << passage.start << ".." << passage.end << " "
               << arbitration_text(passage.frame);
}

/// Frames one after the other: whoever is ready before the start of frame has been sampled takes part, the
/// lowest number wins, three bits lie between.
std::vector<Passage> straight_model(std::vector<std::deque<WireBench::Wish>> wishes) {
    std::vector<Passage> passages;
    std::vector<Time> free(wishes.size(), 0);
    Time idle = 11 * kBit;  // all join at 0
    const auto ready = [&](std::size_t i) { return std::max(free[i], wishes[i].front().time); };
    for (;;) {
        Time first = cosim::kNever;
        for (std::size_t i = 0; i < wishes.size(); ++i)
            if (!wishes[i].empty()) first = std::min(first, ready(i));
        if (first == cosim::kNever) return passages;
        const Time start = std::max(idle, first);
        std::size_t winner = wishes.size();
        for (std::size_t i = 0; i < wishes.size(); ++i) {
            if (wishes[i].empty() || ready(i) > start + kTiming.sample) continue;
            if (winner == wishes.size() ||
                arbitration_text(wishes[i].front().frame) < arbitration_text(wishes[winner].front().frame))
                winner = i;
        }
        const CanFrame frame = wishes[winner].front().frame;
        wishes[winner].pop_front();
        const Time end = start + reference_bits(frame) * kBit;
        passages.push_back({winner, start, end, frame});
        free[winner] = end;
        idle = end + 3 * kBit;
    }
}

}  // namespace

TEST_CASE("frames as bits: the reader reads what was written, and each bit of it is checked") {
    RandomStream random(3, "can");
    for (int i = 0; i < 300; ++i) {
        const CanFrame frame = draw_frame(random);
        const protocols::CanBits bits = can_levels(frame);
        const std::string text = frame_text(frame);
        REQUIRE(bits.count == static_cast<int>(text.size()));
        protocols::CanReader reader;
        for (int bit = 0; bit < bits.count; ++bit) {
            CHECK(bits[bit] == (text[static_cast<std::size_t>(bit)] == '1'));
            CHECK_FALSE(reader.ended());
            CHECK(reader.left() <= bits.count - bit);
            REQUIRE(reader.take(bits[bit]) == protocols::CanError::None);
            CHECK(reader.acknowledges() == (bit + 1 == bits.acknowledge()));
        }
        CHECK(reader.ended());
        CHECK(reader.frame() == frame);
        // One wrong bit is found, before the frame ends, wherever it is but in the acknowledge slot.
        const int wrong = 1 + static_cast<int>(random.below(static_cast<std::uint64_t>(bits.count - 1)));
        if (wrong == bits.acknowledge()) continue;
        protocols::CanReader strict;
        protocols::CanError error = protocols::CanError::None;
        for (int bit = 0; bit < bits.count && error == protocols::CanError::None && !strict.ended(); ++bit)
            error = strict.take(bit == wrong ? !bits[bit] : bits[bit]);
        CHECK((error != protocols::CanError::None || !strict.ended()));
    }
}

TEST_CASE("who sends when is as in a straight model, drawn at random") {
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        CAPTURE(seed);
        RandomStream random(seed, "arbitration");
        const std::size_t stations = 2 + random.below(4);
        WireBench bench(stations);
        bench.join_all();
        const Time span = (1 + static_cast<Time>(random.below(20))) * 100 * kBit;
        for (std::size_t i = 0; i < stations; ++i) {
            std::vector<Time> times;
            for (std::uint64_t k = random.below(8); k > 0; --k)
                // Some at the same bit.
                times.push_back(random.below(3) == 0
                                    ? 50 * kBit + static_cast<Time>(random.below(kBit))
                                    : static_cast<Time>(random.below(static_cast<std::uint64_t>(span))));
            std::sort(times.begin(), times.end());
            for (const Time time : times) {
                CanFrame frame = draw_frame(random);
                // No two senders share an identifier.
                frame.id = frame.id / 8 * 8 + static_cast<std::uint32_t>(i);
                bench.wishes[i].push_back({time, frame});
            }
        }
        const std::vector<Passage> expected = straight_model(bench.wishes);
        bench.run(expected.empty() ? kBit : expected.back().end + kBit);
        std::vector<Passage> seen;
        for (const Told& one : bench.told)
            if (one.news.what == CanNews::What::Sent)
                seen.push_back({one.station, one.news.start, one.time, one.news.frame});
        CHECK(seen == expected);
        // All others received each of them, at the same instant, and nothing else was reported.
        for (std::size_t i = 0; i < stations; ++i) {
            std::vector<Passage> received, of_others;
            for (const Told& one : bench.of(i, CanNews::What::Received))
                received.push_back({0, one.news.start, one.time, one.news.frame});
            for (const Passage& passage : expected)
                if (passage.station != i) of_others.push_back({0, passage.start, passage.end, passage.frame});
            CHECK(received == of_others);
        }
        for (const Told& one : bench.told) {
            CHECK(one.news.what != CanNews::What::Error);
            CHECK(one.tec + one.rec == 0);
        }
    }
}
