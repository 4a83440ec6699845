// Faults of the line's levels, and what a receiver reads.

#include "fault_line.h"

#include "protocols/serial/uart_line.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>

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

TEST_CASE("stop: frames with a parity bit and of nine data bits lose theirs too, and nothing else") {
    for (const UartFrame& like : {UartFrame{.parity = 2}, UartFrame{.parity = 1, .stop_bits = 2},
                                  UartFrame{.data_bits = 9}, UartFrame{.data_bits = 9, .parity = 1}})
        for (unsigned data = 0; data < 256; data += 3) {
            FaultLine line(fault("stop"));
            UartFrame sent = like;
            const bool odd = std::popcount(data) % 2 == 1;
            sent.parity_bit = like.parity != 0 && odd == (like.parity == 2);
            line.send(kMillisecond, data, sent);
            const auto got = sample_frame(line.arrived()[0], {kBit, like.data_bits, like.parity}, 0);
            REQUIRE(got.size() == 1);
            CHECK(got[0].data == data);
            CHECK(got[0].framing_error);
            CHECK_FALSE(got[0].parity_error);
        }
}

TEST_CASE("stop: a short one is an error if it ends before its middle") {
    for (const double length : {0.05, 0.3, 0.48, 0.52, 0.8, 0.97}) {
        const auto got = sample_frame(harmed(fault("stop").set("length", length), 0xA5), {kBit}, 0);
        REQUIRE(got.size() == 1);
        CHECK(got[0].data == 0xA5);
        CHECK(got[0].framing_error == (length < 0.5));
    }
}

TEST_CASE("glitch: only the levels within the pulse are others") {
    RandomStream random(35, "glitch");
    for (int round = 0; round < 200; ++round) {
        const double bit = 9.9 * random.uniform(), width = 3 * to_seconds(kBit) * random.uniform();
        FaultLine line(fault("glitch").set("bit", bit).set("width", width));
        const UartFrame was = line.send(kMillisecond, static_cast<unsigned>(random.below(256)));
        const UartFrame is = line.arrived()[0];
        const Time begin = was.start + static_cast<Time>(bit * static_cast<double>(kBit));
        const Time end = begin + static_cast<Time>(width * 1e12);
        for (int look = 0; look < 60; ++look) {
            const Time time = was.start + static_cast<Time>(random.below(11 * kBit));
            if (std::abs(time - begin) <= kNanosecond || std::abs(time - end) <= kNanosecond) continue;
            const bool within = time >= begin && time < end && time < frame_end(was);
            CHECK(line_is_mark(is, time) == (line_is_mark(was, time) != within));
        }
    }
}

TEST_CASE("glitch: drawn anywhere in the frame, differently with each seed") {
    std::vector<int> bits(10);
    std::vector<std::uint32_t> first;
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
        const UartFrame frame = harmed(fault("glitch").set("width", 1e-6), 0x42, seed);
        ++bits.at(frame.glitch_at * kNanosecond / kBit);
        first.push_back(frame.glitch_at);
        CHECK(frame.glitch_width == 1000);
        CHECK(harmed(fault("glitch").set("width", 1e-6), 0x42, seed) == frame);
    }
    for (const int count : bits)
        CHECK(count > 10);
    std::sort(first.begin(), first.end());
    CHECK(std::unique(first.begin(), first.end()) - first.begin() > 280);
}

TEST_CASE("invert: every level of the window is the other one, at rest too") {
    RandomStream random(36, "invert");
    for (int round = 0; round < 60; ++round) {
        FaultSpec spec = fault("invert");
        spec.begin = kMillisecond - kByte + static_cast<Time>(random.below(4 * kByte));
        spec.end = spec.begin + static_cast<Time>(random.below(8 * kByte));
        FaultLine line(spec);
        UartLine sound, damaged;
        Time at = kMillisecond;
        for (int i = 0; i < 6; ++i) {
            sound.add(line.send(at, static_cast<unsigned>(random.below(256))));
            at += kByte + static_cast<Time>(random.below(2) * random.below(kByte));
        }
        for (const UartFrame& frame : line.arrived())
            damaged.add(frame);
        for (int look = 0; look < 300; ++look) {
            const Time time = kMillisecond - 2 * kByte + static_cast<Time>(random.below(16 * kByte));
            if (std::abs(time - spec.begin) <= 1 || std::abs(time - spec.end) <= 1) continue;
            const bool within = time >= spec.begin && time < spec.end;
            REQUIRE(damaged.level(time) == (sound.level(time) != within));
        }
        CHECK_FALSE(line.early);
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

TEST_CASE("type: bytes without a pause at the line's rate or its own, and nothing else suffers") {
    for (const double baud : {0.0, 9600.0}) {
        FaultSpec spec = fault("type").set("data", "64 2c0D");
        if (baud > 0) spec.set("baud", baud);
        spec.begin = kMillisecond;
        FaultLine line(spec);
        const Time bit = baud > 0 ? std::llround(1e12 / baud) : kBit;
        for (int i = 0; i < 5; ++i)
            line.send(10 * kMillisecond + i * kByte, 0x10u + static_cast<unsigned>(i));
        const std::vector<UartFrame> frames = line.arrived();
        REQUIRE(frames.size() == 8);
        for (std::size_t i = 0; i < 3; ++i) {
            CHECK(frames[i].data == std::array{0x64, 0x2c, 0x0d}[i]);
            CHECK(frames[i].start == kMillisecond + static_cast<Time>(i) * 10 * bit);
            CHECK(frames[i].bit_period == bit);
            CHECK(line.all[i].fault == FaultKind::Insert);
            CHECK(line.all[i].message.time >= frames[i].start + 9 * bit);
        }
        for (std::size_t i = 3; i < 8; ++i)
            CHECK(frames[i].data == 0x10u + i - 3);
        CHECK(line.evidence().fired() == 3);
        CHECK(line.in_turn());
        CHECK_FALSE(line.early);
    }
}

TEST_CASE("type: again after a period, behind what is still on the line") {
    FaultSpec spec = fault("type").set("data", "41 42 43");
    spec.begin = kMillisecond;
    spec.period = 2 * kByte;
    spec.count = 2;
    FaultLine line(spec);
    CHECK(line.bytes() == std::vector<unsigned>{0x41, 0x42, 0x43, 0x41, 0x42, 0x43});
    CHECK(line.in_turn());
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
