// Faults of the line's levels, and what a receiver reads.

#include "fault_line.h"

#include "protocols/uart_sampling.h"

#include <catch2/catch.hpp>

#include <bit>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::protocols;
using toy::FaultLine;
using toy::kBit;
using toy::kByte;

namespace {

FaultSpec fault(const char* kind) {
    FaultSpec spec;
    spec.link = "line";
    spec.kind = kind;
    return spec;
}

UartFrame harmed(const FaultSpec& spec, unsigned data, std::uint64_t seed = 1) {
    FaultLine line(spec, seed);
    line.send(kMillisecond, data);
    return std::get<UartFrame>(line.all.back().message.payload);
}

}  // namespace

TEST_CASE("stop: the data as sent, and a framing error") {
    for (unsigned data = 0; data < 256; ++data) {
        const auto got = sample_frame(harmed(fault("stop"), data), {kBit}, 0);
        REQUIRE(got.size() == 1);
        CHECK(got[0].data == data);
        CHECK(got[0].framing_error);
        CHECK(got[0].is_break == (data == 0));
    }
}

TEST_CASE("invert: a receiver reads what it finds behind the first falling edge") {
    FaultSpec spec = fault("invert");
    spec.end = kSecond;
    for (unsigned data = 0; data < 256; ++data) {
        const UartFrame frame = harmed(spec, data);
        // The line as it is: high for the start bit, the other data bits, low from the stop bit on.
        const auto inverted = [data](int bit) {
            return bit == 0 || (bit <= 8 && (data >> (bit - 1) & 1) == 0);
        };
        int edge = 1;
        while (inverted(edge))
            ++edge;
        CHECK(frame.start == kMillisecond + edge * kBit);
        const auto got = sample_frame(frame, {kBit}, 0);
        REQUIRE(got.size() == 1);
        unsigned expected = 0;
        for (int bit = 0; bit < 8; ++bit)
            expected |= inverted(edge + 1 + bit) ? 1u << bit : 0u;
        CHECK(got[0].data == expected);
        CHECK(got[0].framing_error);
    }
}

TEST_CASE("unplug: of a frame on the way a part arrives, of those within the window nothing") {
    RandomStream random(34, "unplug");
    for (int round = 0; round < 200; ++round) {
        FaultSpec spec = fault("unplug");
        spec.begin = kMillisecond + static_cast<Time>(random.below(kByte));
        spec.end = spec.begin + 3 * kByte + static_cast<Time>(random.below(kByte));
        FaultLine line(spec);
        std::vector<UartFrame> sent;
        for (int i = 0; i < 6; ++i)
            sent.push_back(line.send(kMillisecond + i * kByte, static_cast<unsigned>(random.below(256))));
        const std::vector<UartFrame> arrived = line.arrived();
        for (const UartFrame& was : sent)
            for (int bit = 0; bit < 10; ++bit) {
                const Time middle = was.start + bit * kBit + kBit / 2;
                const bool out = middle >= spec.begin && middle < spec.end;
                bool mark = true;
                for (const UartFrame& frame : arrived)
                    mark = mark && line_is_mark(frame, middle);
                CHECK(mark == (out || line_is_mark(was, middle)));
            }
        CHECK(line.evidence().fired() >= 3);
        CHECK_FALSE(line.early);
    }
}

TEST_CASE("a pulse shorter than half a bit is no start bit") {
    for (const double part : {0.1, 0.3, 0.45, 0.55, 0.8}) {
        FaultSpec spec = fault("false_start").set("width", part * to_seconds(kBit));
        spec.begin = kMillisecond;
        const FaultLine line(spec);
        REQUIRE(line.arrived().size() == 1);
        const auto got = sample_frame(line.arrived()[0], {kBit}, 0);
        CHECK(got.size() == (part > 0.5 ? 1 : 0));
        if (!got.empty()) CHECK(got[0].data == 0xFF);
    }
}
