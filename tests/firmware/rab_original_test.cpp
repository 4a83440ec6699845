// The project's own range-and-bearing firmware beside the original: the same scripts, the same answers, and
// the figures of firmware/rab/README.md. The original's half needs its image in PUCKLOOP_IMAGES.

#include "base/random.h"
#include "protocols/infrared/rab_frame.h"
#include "tests/firmware/rab_bench.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace puckloop;
using namespace puckloop::firmware;
using protocols::encode_rab;

namespace {

const std::string kOwn = std::string(PUCKLOOP_FIRMWARE) + "/rab/rab.hex";
constexpr double kReady = 0.1;            // s: the original needs 85 ms
constexpr double kOriginalReady = 0.004;  // s from a frame's end to its message, with room

/// Frames in light, a poll after each; with `disturb` reads of register 5 begin at that many phases during
/// them.
struct Loss {
    int sent = 0, lost = 0, wrong = 0;
    double fraction() const { return static_cast<double>(lost) / sent; }
};

Loss loss(const std::string& image, int frames, double clock_hertz, bool disturb, const Light& light,
          int size = 16) {
    RabBench bench(image);
    bench.master.clock_hertz = clock_hertz;
    bench.write(kReady - 0.01, {21, static_cast<std::uint8_t>(size)});
    double time = kReady;
    const std::uint32_t mask = size == 32 ? 0xFFFFFFFF : (1U << size) - 1;
    const auto payload = [&](int i) { return (0x9E3779B9U * static_cast<std::uint32_t>(i + 1)) & mask; };
    for (int i = 0; i < frames; ++i) {
        time += 0.010 + i * 13.7e-6;  // another phase each time
        const double end =
            bench.light(time, encode_rab(size, payload(i)), levels({{1, 900}, {2, 700}}), light);
        if (disturb) bench.read(time + (end - time) * (i + 0.5) / frames, 5);
        time = bench.poll(end + kOriginalReady);
    }
    bench.run(time + 0.001);
    Loss out;
    const std::size_t before = disturb ? 1 : 0;
    for (int i = 0; i < frames; ++i) {
        const Message got = message(bench, (kPollReads + before) * static_cast<std::size_t>(i) + before);
        ++out.sent;
        if (!got.there) ++out.lost;
        if (got.there && got.data != payload(i)) ++out.wrong;
    }
    return out;
}

/// Chips of darkness between two frames from which on both arrive.
int shortest_gap(const std::string& image) {
    for (int gap = 1;; ++gap) {
        RabBench bench(image);
        double time = kReady;
        for (std::uint32_t i = 1; i <= 2; ++i)
            time = bench.light(time + gap * kChip, encode_rab(16, i), levels({{1, 900}}));
        time = bench.poll(time + kOriginalReady);
        time = bench.poll(time);
        bench.run(time);
        if (message(bench, 0).data == 1 && message(bench, kPollReads).data == 2) return gap;
    }
}

/// From a frame's last chip until register 0 reports it, s; to 50 us.
double time_to_message(const std::string& image) {
    for (double wait = 0.0002;; wait += 50e-6) {
        RabBench bench(image);
        bench.master.clock_hertz = 400e3;
        const double end = bench.light(kReady, encode_rab(16, 0x1234), levels({{1, 900}, {2, 700}}));
        bench.read(end + wait, 0);
        bench.run(end + wait + 0.001);
        if (bench.reads()[0][0] == 1) return wait;
    }
}

/// Longest time the board held the bus while it was asked to send.
double stretch(const std::string& image, int size) {
    RabBench bench(image);
    bench.write(kReady, {21, static_cast<std::uint8_t>(size)});
    bench.write(kReady + 0.001, {14, 0x5A});
    bench.run(kReady + 0.02);
    return cosim::to_seconds(bench.bus().longest_stretch);
}

/// Frames that a read during them damages on the sender's side.
double damaged(const std::string& image, int frames) {
    RabBench bench(image);
    for (int i = 0; i < frames; ++i) {
        const double time = kReady + 0.02 * i;
        bench.write(time, {14, static_cast<std::uint8_t>(i)});
        bench.read(time + 0.0015 + 0.004 * i / frames, 5);
    }
    bench.run(kReady + 0.02 * frames);
    int bad = frames;
    for (const SentFrame& frame : bench.sent(1))  // no edge off by more than a sixth of a chip
        if (frame.jitter < kChip / 6) --bad;
    return static_cast<double>(bad) / frames;
}

}  // namespace

TEST_CASE("own RAB firmware beside the original: the same script, the same registers and frames") {
    const auto original = exec::real_image("randb.hex");
    if (!original) return;
    RandomStream random(1, "rab script");
    RabBench own(kOwn);
    RabBench real(*original);
    std::size_t polls = 0;
    double time = kReady;
    const auto both = [&](auto&& step) {
        step(own);
        step(real);
    };
    int size = 16;
    for (int round = 0; round < 60; ++round) {
        const std::uint8_t value = static_cast<std::uint8_t>(random.below(256));
        switch (random.below(6)) {
        case 0:
            size = 8 * static_cast<int>(1 + random.below(4));
            both([&](RabBench& b) { b.write(time, {21, static_cast<std::uint8_t>(size)}); });
            break;
        case 1:
            both([&](RabBench& b) { b.write(time, {13, value}); });
            break;
        case 2:
            both([&](RabBench& b) { b.write(time, {20, value, 1, 2}); });
            break;
        case 3:
            both([&](RabBench& b) { b.write(time, {14, value}); });
            break;
        case 4: {
            const auto emitter = static_cast<std::uint8_t>(random.below(12));
            both([&](RabBench& b) { b.write(time, {emitter, value}); });
            both([&](RabBench& b) { b.write(time + 0.001, {15, 0}); });
            break;
        }
        default:
            both([&](RabBench& b) { b.write(time, {12, value}); });
        }
        time += 0.015;
        Levels peaks{};
        const auto first = random.below(12);
        for (std::size_t k = 0; k < 3; ++k)
            peaks[(first + k) % 12] = static_cast<int>(50 + random.below(4000));
        const std::uint32_t payload = (0x9E3779B9U * static_cast<std::uint32_t>(round + 1)) >> (32 - size);
        double end = 0;
        both([&](RabBench& b) { end = b.light(time, encode_rab(size, payload), peaks); });
        time = end + kOriginalReady;
        both([&](RabBench& b) { end = b.poll(time); });
        both([&](RabBench& b) { b.read(end, 1, 9); });
        both([&](RabBench& b) { b.read(end + 0.0015, 10, 3); });
        time = end + 0.003;
        ++polls;
    }
    both([&](RabBench& b) { b.run(time); });
    REQUIRE(own.reads().size() == real.reads().size());
    for (std::size_t i = 0; i < polls; ++i) {
        INFO("round " << i);
        const std::size_t at = (kPollReads + 2) * i;
        const Message a = message(own, at);
        const Message b = message(real, at);
        CHECK(a.there);
        CHECK(b.there);
        CHECK(a.data == b.data);
        CHECK(a.peak == b.peak);
        CHECK(a.sensor == b.sensor);
        CHECK(std::abs(a.bearing - b.bearing) <= 1);
        CHECK(std::abs(a.range - b.range) <= 1);
        for (std::size_t run = at + kPollReads; run < at + kPollReads + 2; ++run) {
            REQUIRE(own.reads()[run].size() == real.reads()[run].size());
            CHECK(own.reads()[run][0] == own.reads()[run][1]);
            CHECK(own.reads()[run][2] == real.reads()[run][2]);
        }
    }
    for (int emitter = 1; emitter <= 12; ++emitter) {
        const auto a = own.sent(emitter);
        const auto b = real.sent(emitter);
        REQUIRE(a.size() == b.size());
        for (std::size_t i = 0; i < a.size(); ++i) {
            CHECK(a[i].chips == b[i].chips);
            CHECK(a[i].chip == Approx(b[i].chip).epsilon(0.0005));
        }
    }
    CHECK(own.rig.get("power") == real.rig.get("power"));
}

TEST_CASE("own RAB firmware: figures of its README") {
    CHECK(shortest_gap(kOwn) == 1);
    CHECK(time_to_message(kOwn) < 0.0010);
    for (const int size : {8, 16, 24, 32})
        CHECK(stretch(kOwn, size) < 12e-6);
    CHECK(damaged(kOwn, 40) == 0);
    for (const double clock : {100e3, 400e3}) {
        const Loss got = loss(kOwn, 40, clock, true, {});
        CHECK(got.lost == 0);
        CHECK(got.wrong == 0);
    }
    CHECK(loss(kOwn, 40, 400e3, false, {kChip, 8e-6, 43e-6}).lost == 0);
    CHECK(loss(kOwn, 40, 400e3, false, {kChip * 1.02, 8e-6, 8e-6}, 32).lost == 0);
}

TEST_CASE("original RAB firmware: the figures that the README sets beside ours") {
    const auto original = exec::real_image("randb.hex");
    if (!original) return;
    CHECK(shortest_gap(*original) == Approx(25).margin(3));
    CHECK(time_to_message(*original) == Approx(0.0029).epsilon(0.1));
    CHECK(stretch(*original, 8) == Approx(0.000419).epsilon(0.03));
    CHECK(stretch(*original, 32) == Approx(0.001923).epsilon(0.03));
    CHECK(damaged(*original, 40) > 0.1);
    CHECK(loss(*original, 40, 100e3, true, {}).fraction() > 0.25);
    CHECK(loss(*original, 40, 400e3, false, {kChip, 8e-6, 43e-6}).fraction() > 0.05);
    CHECK(loss(*original, 40, 400e3, false, {kChip * 1.02, 8e-6, 8e-6}, 32).fraction() > 0.8);
}
