// What receivers of other rates make of a frame.

#include "protocols/serial/uart_sampling.h"

#include <catch2/catch.hpp>

using namespace puckloop::cosim;
using namespace puckloop::protocols;

namespace {
constexpr Time kBit = 8'680'556;  // 115200 baud
constexpr Time kStart = kMillisecond;

UartFrame frame_of(std::uint16_t data, std::uint8_t parity = 0, std::uint8_t parity_bit = 0) {
    UartFrame frame;
    frame.start = kStart;
    frame.bit_period = kBit;
    frame.data = data;
    frame.parity = parity;
    frame.parity_bit = parity_bit;
    return frame;
}
}  // namespace

TEST_CASE("a receiver of the same rate takes every byte in the middle of its stop bit") {
    for (unsigned data = 0; data < 256; ++data) {
        const auto got = sample_frame(frame_of(static_cast<std::uint16_t>(data)), {kBit}, 0);
        REQUIRE(got.size() == 1);
        CHECK(got[0].data == data);
        CHECK_FALSE(got[0].framing_error);
        CHECK(got[0].time == kStart + 9 * kBit + kBit / 2);
    }
}

TEST_CASE("up to 4 % of error the byte survives, at 7 % it does not") {
    for (const double error : {-0.04, 0.04}) {
        const auto period = static_cast<Time>(static_cast<double>(kBit) * (1 + error));
        const auto got = sample_frame(frame_of(0x55), {period}, 0);
        REQUIRE(got.size() == 1);
        CHECK(got[0].data == 0x55);
        CHECK_FALSE(got[0].framing_error);
    }
    const auto fast = sample_frame(frame_of(0x55), {static_cast<Time>(kBit * 0.93)}, 0);
    REQUIRE_FALSE(fast.empty());
    CHECK(fast[0].framing_error);  // the stop bit is sampled in the last data bit, which is low
}

TEST_CASE("a receiver of twice the rate reads each bit twice, and perhaps a second character") {
    // 0x0F: start, 4 high, 4 low, stop. Seen at half the bit time: low low, 8 high, then 8 low, 2 high.
    const auto got = sample_frame(frame_of(0x0F), {kBit / 2}, 0);
    REQUIRE(got.size() == 2);
    CHECK(got[0].data == 0xFE);
    CHECK_FALSE(got[0].framing_error);
    CHECK(got[1].data == 0x80);
    CHECK_FALSE(got[1].framing_error);
}

TEST_CASE("parity is checked, breaks are no framing errors") {
    CHECK_FALSE(sample_frame(frame_of(0x07, 2, 1), {kBit, 8, 2}, 0)[0].parity_error);
    CHECK(sample_frame(frame_of(0x07, 2, 0), {kBit, 8, 2}, 0)[0].parity_error);
    CHECK(sample_frame(frame_of(0x07, 2, 1), {kBit, 8, 1}, 0)[0].parity_error);
    UartFrame line_low = frame_of(0);
    line_low.is_break = 1;
    const auto got = sample_frame(line_low, {kBit}, 0);
    REQUIRE(got.size() == 1);
    CHECK(got[0].is_break);
    CHECK(got[0].framing_error);
}

TEST_CASE("a receiver that is busy waits for the next falling edge") {
    // Ready only in data bit 1 of 0x01: bits 1 to 7 are low, so the next edge never comes.
    CHECK(sample_frame(frame_of(0x01), {kBit}, kStart + 2 * kBit + 1).empty());
    // Ready in the high bit 0: the falling edge into bit 1 is taken for a start bit.
    CHECK(sample_frame(frame_of(0x01), {kBit}, kStart + kBit + 1).size() == 1);
}
