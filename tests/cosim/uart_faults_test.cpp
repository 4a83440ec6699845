// Each kind of fault of a UART, with values drawn at random, against what it is meant to do to the bytes.

#include "fault_line.h"

#include "protocols/serial/uart_sampling.h"

#include "base/error.h"

#include <catch2/catch.hpp>

#include <bit>
#include <cmath>

using namespace puckloop;
using namespace puckloop::cosim;
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

FaultSpec some(const char* kind, RandomStream& random) {
    FaultSpec spec = fault(kind);
    spec.skip = random.below(5);
    spec.every = 1 + random.below(7);
    return spec;
}

bool suffers(const FaultSpec& spec, std::size_t i) {
    return i >= spec.skip && (i - spec.skip) % spec.every == 0;
}

}  // namespace

TEST_CASE("flip: so many bits, where they are asked for") {
    RandomStream random(1, "flip");
    for (int round = 0; round < 60; ++round) {
        const auto bits = static_cast<unsigned>(1 + random.below(8));
        FaultSpec spec = some("flip", random).set("bits", bits);
        const bool burst = round % 3 == 1, chosen = round % 3 == 2;
        const auto bit = static_cast<unsigned>(random.below(9 - bits));
        if (burst) spec.set("burst", 1);
        if (chosen) spec.set("bit", bit);
        FaultLine line(spec, random.next());
        const std::vector<unsigned> sent = line.send_records(4, 20, random);
        const std::vector<unsigned> got = line.bytes();
        REQUIRE(got.size() == sent.size());
        for (std::size_t i = 0; i < sent.size(); ++i) {
            const unsigned changed = sent[i] ^ got[i];
            CHECK(std::popcount(changed) == (suffers(spec, i) ? static_cast<int>(bits) : 0));
            if (!suffers(spec, i)) continue;
            const unsigned run = (1u << bits) - 1;
            if (burst) CHECK(changed == run << std::countr_zero(changed));
            if (chosen) CHECK(changed == run << bit);
        }
        CHECK_FALSE(line.early);
    }
}

TEST_CASE("insert: a byte more, and the line carries one at a time") {
    RandomStream random(2, "insert");
    for (int round = 0; round < 40; ++round) {
        FaultSpec spec = some("insert", random);
        const auto value = static_cast<unsigned>(random.below(256));
        if (round % 2) spec.set("value", value);
        FaultLine line(spec, random.next());
        const std::vector<unsigned> sent = line.send_records(3, 15, random), got = line.bytes();
        std::size_t at = 0;
        for (std::size_t i = 0; i < sent.size(); ++i) {
            REQUIRE(at < got.size());
            CHECK(got[at++] == sent[i]);
            if (!suffers(spec, i)) continue;
            REQUIRE(at < got.size());
            if (round % 2) CHECK(got[at] == value);
            ++at;
        }
        CHECK(at == got.size());
        CHECK(line.in_turn());
        CHECK_FALSE(line.early);
    }
}

TEST_CASE("swap: neighbours change places, nothing is lost but a last one without a neighbour") {
    RandomStream random(3, "swap");
    for (int round = 0; round < 40; ++round) {
        FaultSpec spec = fault("swap");
        spec.skip = random.below(30);
        spec.count = 1;
        FaultLine line(spec);
        std::vector<unsigned> sent = line.send_records(3, 10, random);
        if (spec.skip + 1 < sent.size())
            std::swap(sent[spec.skip], sent[spec.skip + 1]);
        else
            sent.pop_back();
        CHECK(line.bytes() == sent);
        CHECK(line.in_turn());
        CHECK_FALSE(line.early);
        CHECK(line.evidence().fired() == 1);
    }
    FaultLine all(fault("swap"));
    const std::vector<unsigned> sent = all.send_records(1, 40, random), got = all.bytes();
    for (std::size_t i = 0; i + 1 < got.size(); i += 2) {
        CHECK(got[i] == sent[i + 1]);
        CHECK(got[i + 1] == sent[i]);
    }
}

TEST_CASE("truncate: only the beginnings of records arrive") {
    RandomStream random(4, "truncate");
    for (int round = 0; round < 30; ++round) {
        const auto keep = static_cast<int>(random.below(14));
        constexpr int kLength = 12, kRecords = 9;
        FaultSpec spec = some("truncate", random).set("keep", keep);
        FaultLine line(spec);
        const std::vector<unsigned> sent = line.send_records(kRecords, kLength, random);
        std::vector<unsigned> expected;
        for (int r = 0; r < kRecords; ++r)
            for (int i = 0; i < kLength; ++i)
                if (i < keep || !suffers(spec, static_cast<std::size_t>(r)))
                    expected.push_back(sent[static_cast<std::size_t>(r * kLength + i)]);
        CHECK(line.bytes() == expected);
    }
}

TEST_CASE("position, match and offset choose the byte") {
    RandomStream random(5, "match");
    for (int round = 0; round < 60; ++round) {
        FaultSpec spec = fault("drop");
        const bool placed = round % 2;
        if (placed) spec.position = static_cast<std::uint32_t>(random.below(20));
        FaultLine probe(fault("drop"));
        // Few different bytes: patterns come often, and overlap.
        if (!placed) {
            for (std::uint64_t n = 1 + random.below(3); n > 0; --n)
                spec.match.push_back(static_cast<std::uint8_t>(random.below(3)));
            spec.offset = static_cast<std::uint32_t>(random.below(4));
        }
        FaultLine line(spec);
        std::vector<unsigned> sent, expected;
        for (int r = 0; r < 5; ++r, line.now += 30 * kByte)
            for (int i = 0; i < 20; ++i, line.now += kByte) {
                sent.push_back(static_cast<unsigned>(random.below(3)));
                line.send(line.now, sent.back());
            }
        for (std::size_t i = 0; i < sent.size(); ++i) {
            bool meant = placed && i % 20 == *spec.position;
            if (!placed && i + 1 >= spec.match.size() + spec.offset) {
                const std::size_t from = i + 1 - spec.offset - spec.match.size();
                meant =
                    std::equal(spec.match.begin(), spec.match.end(), sent.begin() + static_cast<long>(from));
            }
            if (!meant) expected.push_back(sent[i]);
        }
        CHECK(line.bytes() == expected);
    }
}

TEST_CASE("parity: wrong, or stuck at a level") {
    RandomStream random(6, "parity");
    for (const char* mode : {"wrong", "mark", "space"})
        for (const std::uint8_t parity : {std::uint8_t{1}, std::uint8_t{2}}) {
            FaultLine line(fault("parity").set("mode", mode));
            for (int i = 0; i < 50; ++i, line.now += 12 * kBit) {
                const auto data = static_cast<unsigned>(random.below(256));
                const bool odd = std::popcount(data) % 2 == 1;
                UartFrame frame;
                frame.parity = parity;
                frame.parity_bit = odd != (parity == 1);
                line.send(line.now, data, frame);
                const UartFrame& got = std::get<UartFrame>(line.all.back().message.payload);
                const std::string name = mode;
                CHECK(got.parity_bit == (name == "mark" ? 1 : name == "space" ? 0 : 1 - frame.parity_bit));
                CHECK(got.data == data);
            }
        }
    FaultLine none(fault("parity"));
    none.send_records(2, 10, random);
    CHECK(none.evidence().fired() == 0);
}

TEST_CASE("delay with jitter: within bounds, in order, one at a time") {
    RandomStream random(7, "jitter");
    for (int round = 0; round < 20; ++round) {
        const double delay = 1e-3 * random.uniform(), jitter = delay * random.uniform();
        FaultLine line(fault("delay").set("delay", delay).set("jitter", jitter), random.next());
        const std::vector<unsigned> sent = line.send_records(5, 1, random);
        CHECK(line.bytes() == sent);
        CHECK_FALSE(line.early);
        for (std::size_t i = 0; i < sent.size(); ++i) {
            const Time late = line.arrived()[i].start - (kMillisecond + static_cast<Time>(i) * 31 * kByte);
            CHECK(to_seconds(late) >= delay - jitter - 1e-11);
            CHECK(to_seconds(late) <= delay + jitter + 1e-11);
        }
        line.send_records(4, 30, random);
        CHECK(line.in_turn());
    }
}

TEST_CASE("baud: the bit time follows offset and drift") {
    RandomStream random(8, "baud");
    for (int round = 0; round < 20; ++round) {
        const double offset = 0.12 * random.uniform() - 0.06, drift = 0.02 * random.uniform() - 0.01;
        FaultLine line(fault("baud").set("offset", offset).set("drift", drift));
        for (int i = 0; i < 20; ++i, line.now += 50 * kMillisecond) {
            line.send(line.now, 0x55);
            const double factor = 1 / (1 + offset + drift * to_seconds(line.now));
            const auto& got = std::get<UartFrame>(line.all.back().message.payload);
            CHECK(static_cast<double>(got.bit_period) == Approx(factor * kBit).margin(1));
        }
        line.send_records(2, 20, random);
        CHECK(line.in_turn());
        CHECK_FALSE(line.early);
    }
}

TEST_CASE("batch: frames come out at the ends of slots") {
    RandomStream random(9, "batch");
    const Time slot = 16 * kMillisecond;
    FaultLine line(fault("batch").set("slot", 0.016));
    std::vector<unsigned> sent;
    for (int i = 0; i < 200; ++i) {
        line.now += kByte + static_cast<Time>(random.below(3 * kMillisecond));
        sent.push_back(static_cast<unsigned>(random.below(256)));
        line.send(line.now, sent.back());
    }
    CHECK(line.bytes() == sent);
    CHECK(line.in_turn());
    CHECK_FALSE(line.early);
    int first = 0;
    Time before = 0;
    for (const UartFrame& frame : line.arrived()) {
        if (frame.start > before + 2 * kByte) {  // the first of a batch ends with the slot
            CHECK((frame.start + kByte) % slot == 0);
            ++first;
        }
        before = frame.start;
    }
    CHECK(first > 10);
}

TEST_CASE("throttle: never faster than the rate, and a full queue loses") {
    RandomStream random(10, "throttle");
    FaultLine line(fault("throttle").set("rate", 9600));
    const std::vector<unsigned> sent = line.send_records(3, 20, random);
    CHECK(line.bytes() == sent);
    const std::vector<UartFrame> got = line.arrived();
    const Time slow = from_seconds(10 / 9600.0);
    for (std::size_t i = 1; i < got.size(); ++i)
        CHECK(got[i].start - got[i - 1].start >= slow - 2);
    FaultLine small(fault("throttle").set("rate", 9600).set("limit", 4));
    small.send_records(1, 40, random);
    // Twelve come while one goes.
    CHECK(small.bytes().size() >= 4 + 40 / 12);
    CHECK(small.bytes().size() <= 4 + 40 / 12 + 2);
    CHECK_FALSE(small.early);
}

TEST_CASE("stall: all waits for the end of the window") {
    RandomStream random(11, "stall");
    FaultSpec spec = fault("stall");
    spec.begin = 2 * kMillisecond;
    spec.end = 9 * kMillisecond;
    FaultLine line(spec);
    const std::vector<unsigned> sent = line.send_records(8, 10, random);
    CHECK(line.bytes() == sent);
    CHECK(line.in_turn());
    for (const UartFrame& frame : line.arrived())
        CHECK((frame.start < spec.begin || frame.start >= spec.end));
    CHECK(line.evidence().fired() > 10);
}

TEST_CASE("disconnect, swapped wires and a line stuck high: silence in the window, and nothing else") {
    RandomStream random(12, "silence");
    for (const char* kind : {"disconnect", "swapped_wires", "stuck"}) {
        FaultSpec spec = fault(kind);
        if (spec.kind == "stuck") spec.set("level", "high");
        spec.begin = 3 * kMillisecond;
        spec.end = 8 * kMillisecond;
        FaultLine line(spec);
        const std::vector<unsigned> sent = line.send_records(6, 12, random);
        std::size_t inside = 0;
        for (const UartFrame& frame : line.arrived()) {
            CHECK((frame.start < spec.begin || frame.start >= spec.end));
            ++inside;
        }
        CHECK(inside + line.evidence().fired() == sent.size());
        CHECK(line.evidence().fired() > 10);
    }
}

TEST_CASE("breaks and false starts come at their instants") {
    RandomStream random(13, "pulses");
    for (int round = 0; round < 20; ++round) {
        FaultSpec spec = fault(round % 2 ? "break" : "false_start");
        spec.begin = static_cast<Time>(random.below(kSecond));
        spec.period = kMillisecond + static_cast<Time>(random.below(kSecond));
        spec.count = 1 + random.below(9);
        const double width = 1e-6 * (1 + static_cast<double>(random.below(1000)));
        spec.set(round % 2 ? "length" : "width", width);
        const FaultLine line(spec);
        const std::vector<UartFrame> got = line.arrived();
        REQUIRE(got.size() == spec.count);
        for (std::size_t i = 0; i < got.size(); ++i) {
            CHECK(got[i].start == spec.begin + static_cast<Time>(i) * spec.period);
            const Time low = std::llround(width * 1e12);
            CHECK_FALSE(protocols::line_is_mark(got[i], got[i].start));
            CHECK_FALSE(protocols::line_is_mark(got[i], got[i].start + low - 20));
            CHECK(protocols::line_is_mark(got[i], got[i].start + low + 20));
            CHECK(line.all[i].message.time >= got[i].start + 9 * kBit);
        }
        CHECK(line.evidence().fired() == spec.count);
        // Of a run that ends before, only those that happened.
        const Time end = spec.begin + static_cast<Time>(random.below(10 * kSecond));
        std::uint64_t until = 0;
        for (const Delivery& one : line.all)
            until += one.message.time < end ? 1 : 0;
        CHECK(line.evidence().fired(end) == until);
        CHECK(line.evidence().firings(end).size() == until);
        CHECK(line.evidence().last(end).value_or(-1) ==
              (until == 0 ? -1 : spec.begin + static_cast<Time>(until - 1) * spec.period));
    }
    const FaultLine usual(fault("break"));
    REQUIRE(usual.arrived().size() == 1);
    CHECK(10 * usual.arrived()[0].bit_period > kByte + 2 * kBit);
}

TEST_CASE("kinds refuse what they cannot do") {
    const auto refused = [](const FaultSpec& spec) { CHECK_THROWS_AS(FaultLine(spec), InputError); };
    refused(fault("stall"));
    refused(fault("baud"));
    refused(fault("truncate"));
    refused(fault("explode"));
    refused(fault("drop").set("factor", 2));
    refused(fault("flip").set("bits", 2.5));
    refused(fault("flip").set("bits", 5).set("bit", 5));
    refused(fault("delay").set("delay", 1e-3).set("jitter", 2e-3));
    refused(fault("parity").set("mode", "odd"));
    FaultSpec endless = fault("break");
    endless.period = kMillisecond;
    refused(endless);
    FaultSpec one_way = fault("swapped_wires");
    one_way.from = "sender";
    refused(one_way);
    for (const char* kind : {"unplug", "invert", "loopback"}) {
        FaultSpec some = fault(kind);
        CHECK_NOTHROW(FaultLine(some));
        some.count = 1;
        refused(some);
        some.count = ~0ull;
        some.probability = 0.5;
        refused(some);
        some.probability = 1.0;
        some.bytes = {0x41};
        refused(some);
    }
    FaultSpec never = fault("drop");
    never.every = 0;
    refused(never);
    never.every = 1;
    never.burst = Burst{1.5, 0.5};
    refused(never);
}
