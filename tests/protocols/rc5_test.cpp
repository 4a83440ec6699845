// The remote control's waveform as firmware samples it.

#include "protocols/infrared/rc5.h"

#include <catch2/catch.hpp>

#include <string>

using namespace puckloop::protocols;

namespace {

bool level_at(const std::vector<Rc5Edge>& edges, double microseconds) {
    bool high = true;
    for (const Rc5Edge& edge : edges)
        if (edge.microseconds <= microseconds) high = edge.high;
    return high;
}

/// The bits as a receiver takes them: in the middle of each bit's first half.
std::string bits_of(const std::vector<Rc5Edge>& edges) {
    std::string bits;
    for (int bit = 0; bit < kRc5Bits; ++bit)
        bits += level_at(edges, (2 * bit + 0.5) * kRc5HalfBitMicroseconds) ? '1' : '0';
    return bits;
}

}  // namespace

TEST_CASE("an RC5 frame has its fields where the format has them, and every bit changes in its middle") {
    CHECK(bits_of(rc5_frame(false, 0, 0)) == "11000000000000");
    CHECK(bits_of(rc5_frame(true, 5, 35)) == "11100101100011");
    CHECK(bits_of(rc5_frame(false, 31, 63)) == "11011111111111");
    for (int command = 0; command < 64; ++command) {
        const auto edges = rc5_frame(command % 2 == 0, command % 32, command);
        for (int bit = 0; bit < kRc5Bits; ++bit)
            CHECK(level_at(edges, (2 * bit + 0.5) * kRc5HalfBitMicroseconds) !=
                  level_at(edges, (2 * bit + 1.5) * kRc5HalfBitMicroseconds));
        CHECK(edges.front().microseconds == kRc5HalfBitMicroseconds);
        CHECK_FALSE(edges.front().high);
        CHECK(edges.back().high);
    }
}

TEST_CASE("a frame lasts 24.9 ms and is repeated after 113.8 ms") {
    CHECK(rc5_frame(false, 0, 1).back().microseconds <= 24'892);
    CHECK(kRc5RepeatMicroseconds == 113'792);
}
