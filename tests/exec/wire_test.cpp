#include "tools/exec/wire.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using exec::frame_of;
using exec::sample;

namespace {
constexpr cosim::Time kBit = 8'680'556;  // 115 200 baud
}

TEST_CASE("a frame at the receiver's own rate gives its byte") {
    for (int byte = 0; byte < 256; ++byte) {
        const auto seen = sample(frame_of(static_cast<std::uint8_t>(byte), 12345, kBit), kBit);
        CHECK(seen.byte == byte);
        CHECK(seen.clean);
    }
}

TEST_CASE("4 % of error in the rate is read, 8 % is not") {
    // The stop bit is sampled at 9.5 bits: half a bit of slack there allows 5 %.
    for (const double error : {-0.04, 0.04}) {
        const auto period = static_cast<cosim::Time>(static_cast<double>(kBit) * (1 + error));
        CHECK(sample(frame_of(0x55, 0, period), kBit).byte == 0x55);
        CHECK(sample(frame_of(0x00, 0, period), kBit).clean);
    }
    const auto slow = static_cast<cosim::Time>(static_cast<double>(kBit) * 1.08);
    CHECK_FALSE(sample(frame_of(0x00, 0, slow), kBit).clean);
}

TEST_CASE("half the rate gives the usual garbage, a break a framing error") {
    const auto seen = sample(frame_of(0x55, 0, 2 * kBit), kBit);
    CHECK(seen.byte ==
          0x66);  // 1010... with every bit seen twice, shifted by the second half of the start bit
    cosim::UartFrame line_break = frame_of(0, 0, kBit);
    line_break.is_break = 1;
    CHECK_FALSE(sample(line_break, kBit).clean);
}

TEST_CASE("the stop bit follows data and parity") {
    cosim::UartFrame frame = frame_of(1, 1000, 10);
    CHECK(exec::stop_bit(frame) == 1090);
    frame.parity = 2;
    CHECK(exec::stop_bit(frame) == 1100);
    frame.data_bits = 9;
    CHECK(exec::stop_bit(frame) == 1110);
}
