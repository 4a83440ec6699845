// The project's own range-and-bearing firmware: what it receives, through noise, errors, polls and
// neighbours.

#include "protocols/infrared/rab_frame.h"
#include "tests/firmware/rab_bench.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace puckloop;
using namespace puckloop::firmware;
using protocols::encode_rab;

namespace {

const std::string kImage = std::string(PUCKLOOP_FIRMWARE) + "/rab/rab.hex";
constexpr double kReady = 0.02;       // s
constexpr double kReadable = 0.0012;  // s from a frame's last chip to its message
constexpr double kGap = 3.2;          // chips between frames that are sent one after the other

/// Peaks and what the board makes of them: fact sheet 4.4, measured on the original.
struct Vector {
    Levels peaks;
    int bearing, range, peak, sensor;
};

std::vector<Vector> golden() {
    std::vector<Vector> all{
        {levels({{0, 1000}, {1, 550}, {11, 600}}), 2696, 1041, 1000, 0},
        {levels({{0, 1500}, {1, 800}, {11, 900}}), 2648, 1561, 1500, 0},
        {levels({{0, 1000}, {11, 1000}}), 0, 1210, 1000, 0},
        {levels({{0, 1000}, {1, 500}}), 4625, 1027, 1000, 0},
        {levels({{0, 500}, {1, 1000}}), 6719, 1027, 1000, 1},
        {levels({{5, 900}, {6, 900}}), 30892, 1097, 900, 5},
        {levels({{5, 1000}, {6, 400}}), 29508, 1015, 1000, 5},
        {levels({{5, 300}, {6, 2000}, {7, 1500}}), -27192, 2170, 2000, 6},
        {levels({{2, 1000}, {8, 1000}}), 0, 2337, 1000, 2},
        {levels({{7, 2000}, {8, 4095}, {9, 4095}}), -17352, 4975, 4095, 8},
        {levels({{9, 700}, {10, 650}}), -11171, 815, 700, 9},
        {levels({{0, 2400}, {1, 500}, {10, 600}, {11, 2500}}), -188, 2966, 2500, 11},
        {levels({{0, 4095}, {6, 4095}}), 0, 4954, 4095, 0},
        {levels({{4, 1991}, {5, 1117}, {6, 858}}), 26730, 2098, 1991, 4},
        {levels({{7, 242}, {8, 1997}, {9, 1243}}), -16935, 2085, 1997, 8},
        {levels({{0, 542}, {1, 871}, {2, 1178}}), 9509, 1290, 1178, 2},
        {levels({{2, 1200}, {3, 1200}}), 15707, 1452, 1200, 2},  // the original reports 0, 2805
    };
    const int bearings[12]{2617,   8726,   13089,  18325,  23212, 27750,
                           -28797, -23561, -18325, -13439, -8726, -2617};
    for (int i = 0; i < 12; ++i)
        all.push_back({levels({{i, 4095}}), bearings[i], 4095, 4095, i});
    return all;
}

/// One count and 1e-4 rad: what cutting off may make of the formulas' last digits.
void check_near(const Message& got, const Vector& expected) {
    CHECK(got.peak == expected.peak);
    CHECK(got.range == Approx(expected.range).margin(1));
    CHECK(got.bearing == Approx(expected.bearing).margin(1));
    CHECK(got.sensor == expected.sensor);
}

/// Frames one after the other, each polled after it; how many came with the right data.
struct Delivery {
    int sent = 0, right = 0, wrong = 0;
};

Delivery deliver(const std::vector<double>& starts, const Light& light, int size = 16) {
    RabBench bench(kImage);
    bench.master.clock_hertz = 400e3;
    bench.write(kReady - 0.005, {21, static_cast<std::uint8_t>(size)});
    Delivery out;
    double time = kReady;
    std::vector<std::uint32_t> payloads;
    for (const double start : starts) {
        const std::uint32_t payload =
            (0x9E3779B9U * static_cast<std::uint32_t>(payloads.size() + 1)) >> (32 - size);
        payloads.push_back(payload);
        time = bench.light(time + start, encode_rab(size, payload), levels({{1, 900}, {2, 700}}), light);
        time = bench.poll(time + kReadable);
    }
    bench.run(time + 0.001);
    for (std::size_t i = 0; i < payloads.size(); ++i) {
        const Message got = message(bench, kPollReads * i);
        ++out.sent;
        if (!got.there) continue;
        ++(got.data == payloads[i] ? out.right : out.wrong);
    }
    return out;
}

}  // namespace

TEST_CASE("own RAB firmware: bearing, range, peak and sensor by the formulas") {
    const std::vector<Vector> vectors = golden();
    RabBench bench(kImage);
    double time = kReady;
    for (const Vector& vector : vectors) {
        time = bench.light(time, encode_rab(16, 0x1234), vector.peaks);
        time = bench.poll(time + kReadable);
    }
    bench.read(time, 0);
    bench.run(time + 0.001);
    for (std::size_t i = 0; i < vectors.size(); ++i) {
        const Message got = message(bench, kPollReads * i);
        INFO("vector " << i);
        CHECK(got.there);
        CHECK(got.data == 0x1234);
        check_near(got, vectors[i]);
    }
    CHECK(bench.reads().back()[0] == 0);
    CHECK(bench.rig.chip().report().traps.empty());
    CHECK(bench.rig.chip().report().unmodelled.empty());
}

TEST_CASE("own RAB firmware: a message without light above darkness has no sensor") {
    RabBench bench(kImage);
    Levels dim{};
    dim[3] = 1;
    double time = kReady;
    for (int i = 0; i < 12; ++i)
        bench.signal(0, "peak" + std::to_string(i + 1), 500);
    time = bench.light(time, encode_rab(16, 0x1234), dim);
    bench.poll(time + kReadable);
    bench.run(time + 0.01);
    const Message got = message(bench, 0);
    CHECK(got.there);
    CHECK(got.bearing == 0);
    CHECK(got.range == 0);
    CHECK(got.peak == 0);
    CHECK(got.sensor == 12);
}

TEST_CASE("own RAB firmware: all payload sizes, frames follow each other by three dark chips") {
    for (const int size : {8, 16, 24, 32}) {
        RabBench bench(kImage);
        bench.write(kReady - 0.005, {21, static_cast<std::uint8_t>(size)});
        double time = kReady;
        std::vector<std::uint32_t> payloads;
        for (std::uint32_t i = 0; i < 12; ++i) {
            payloads.push_back((0x9E3779B9U * (i + 1)) >> (32 - size));
            time = bench.light(time, encode_rab(size, payloads.back()), levels({{0, 800}, {11, 800}}));
            time += kGap * kChip;
        }
        for (std::size_t i = 0; i < 11; ++i)
            time = bench.poll(time + 0.001);
        bench.run(time + 0.001);
        for (std::size_t i = 0; i < 10; ++i) {
            const Message got = message(bench, kPollReads * i);
            CHECK(got.there);
            CHECK(got.data == payloads[i]);  // ten wait, the newest are dropped
            CHECK(got.peak == 800);
        }
        CHECK_FALSE(message(bench, kPollReads * 10).there);
    }
}

TEST_CASE("own RAB firmware: any phase, pulses longer or shorter by 35 us, clocks 2 % off") {
    std::vector<double> phases;
    for (int i = 0; i < 24; ++i)
        phases.push_back(0.001 + i * 4.1e-6);
    for (const double distortion : {-35e-6, -15e-6, 0.0, 15e-6, 35e-6}) {
        const Light light{kChip, 40e-6, 40e-6 + distortion};
        const Delivery got = deliver(phases, light);
        INFO("distortion " << distortion);
        CHECK(got.right == got.sent);
    }
    for (const double mismatch : {0.98, 0.998, 1.002, 1.02})
        for (const int size : {16, 32}) {
            const Delivery got = deliver(phases, {kChip * mismatch, 8e-6, 8e-6}, size);
            INFO("mismatch " << mismatch);
            CHECK(got.right == got.sent);
        }
}

TEST_CASE("own RAB firmware: polls during the frame take nothing away") {
    RabBench bench(kImage);  // 100 kHz
    double time = kReady;
    for (std::uint32_t i = 0; i < 8; ++i) {
        const double end = bench.light(time, encode_rab(16, 0x0100 + i), levels({{5, 900}}));
        for (double poll = time; poll < end - 0.0005; poll += 0.0005)
            bench.read(poll, 5);
        time = bench.poll(end + kReadable);
    }
    bench.run(time + 0.001);
    std::uint32_t seen = 0;
    for (std::size_t i = 0; i + kPollReads <= bench.reads().size(); ++i)
        if (bench.reads()[i][0] == 1 && message(bench, i).data == 0x0100 + seen) ++seen;
    CHECK(seen == 8);
}

TEST_CASE("own RAB firmware: two senders at the same time on other sensors are two messages") {
    for (const double later : {0.0, 0.3, 1.0, 7.5, 30.0}) {
        RabBench bench(kImage);
        const double first = bench.light(kReady, encode_rab(16, 0x1111), levels({{0, 1500}, {1, 900}}));
        const double second =
            bench.light(kReady + later * kChip, encode_rab(16, 0x2222), levels({{6, 700}, {7, 800}}));
        double time = bench.poll(std::max(first, second) + kReadable);
        time = bench.poll(time);
        bench.run(time);
        Message a = message(bench, 0);
        Message b = message(bench, kPollReads);
        INFO("later by " << later);
        REQUIRE(a.there);
        REQUIRE(b.there);
        if (a.data == 0x2222) std::swap(a, b);
        CHECK(a.data == 0x1111);
        CHECK(b.data == 0x2222);
        CHECK(a.peak == 1500);
        CHECK(b.peak == 800);
        CHECK(a.bearing > 0);
        CHECK(b.bearing < -20000);
    }
}

TEST_CASE("own RAB firmware: after any broken frame the next one is received, with its own peaks") {
    const std::string good = encode_rab(16, 0xBEEF);
    std::vector<std::string> broken;
    for (int noise = 1; noise <= 9; ++noise)
        broken.push_back(std::string(static_cast<std::size_t>(noise), '1'));
    for (std::size_t length = 7; length < good.size(); length += 3)
        broken.push_back(good.substr(0, length));
    for (std::size_t chip = 6; chip < good.size(); chip += 3) {
        std::string flipped = good;
        flipped[chip] = flipped[chip] == '1' ? '0' : '1';
        broken.push_back(flipped);
    }
    for (std::size_t bit = 6; bit < good.size(); bit += 6) {  // well formed, bad check
        std::string swapped = good;
        std::swap(swapped[bit], swapped[bit + 1]);
        broken.push_back(swapped);
    }
    broken.push_back(encode_rab(8, 0x5A));
    broken.push_back(encode_rab(32, 0x0000005A));
    broken.push_back(encode_rab(24, 0x12345));
    broken.push_back(encode_rab(32, 0));  // begins as a good frame of 16 bits does
    broken.push_back(encode_rab(24, 0));
    RabBench bench(kImage);
    double time = kReady;
    for (const std::string& chips : broken) {
        time = bench.light(time, chips, levels({{0, 2000}, {1, 1500}}));
        time = bench.light(time + kGap * kChip, good, levels({{6, 600}, {7, 500}}));
        time = bench.poll(time + kReadable);
        bench.read(time, 0);
        time += 0.001;
    }
    bench.run(time);
    for (std::size_t i = 0; i < broken.size(); ++i) {
        const Message got = message(bench, (kPollReads + 1) * i);
        INFO(broken[i]);
        CHECK(got.there);
        CHECK(got.data == 0xBEEF);
        CHECK(got.peak == 600);
        CHECK(bench.reads()[(kPollReads + 1) * i + kPollReads][0] == 0);  // nothing came of the broken one
    }
}

TEST_CASE("own RAB firmware: a sensor that is always lit costs the others nothing") {
    RabBench bench(kImage);
    bench.signal(kReady - 0.003, "demod7", 1);
    double time = bench.light(kReady, encode_rab(16, 0x1234), levels({{0, 900}, {1, 700}}));
    time = bench.poll(time + kReadable);
    bench.run(time);
    CHECK(message(bench, 0).there);
    CHECK(message(bench, 0).data == 0x1234);
}

TEST_CASE(
    "own RAB firmware: darkness is measured without the light of the last frame, nor of the present one") {
    RabBench bench(kImage);
    double time = kReady;
    time = bench.light(time, encode_rab(16, 1), levels({{0, 1500}}));
    time = bench.poll(time + kReadable);
    bench.write(time, {16, 0});  // the detector holds 1500 still
    time = bench.light(time + 0.004, encode_rab(16, 2), levels({{0, 1500}}));
    time = bench.poll(time + kReadable);
    bench.write(time, {16, 0});
    time = bench.light(time + 0.0015, encode_rab(16, 3), levels({{0, 1500}}));  // in the middle of it
    time = bench.poll(time + kReadable);
    for (int i = 0; i < 12; ++i)
        bench.signal(time, "peak" + std::to_string(i + 1), 300);
    bench.write(time + 0.001, {16, 0});
    time = bench.light(time + 0.006, encode_rab(16, 4), levels({{0, 1500}}));
    time = bench.poll(time + kReadable);
    bench.run(time);
    for (std::size_t i = 0; i < 4; ++i) {
        const Message got = message(bench, kPollReads * i);
        CHECK(got.data == i + 1);
        CHECK(got.peak == (i == 3 ? 1200 : 1500));
    }
}

TEST_CASE("own RAB firmware: raw peaks, frame after frame") {
    RabBench bench(kImage);
    bench.write(kReady - 0.005, {17, 1});
    double time = kReady;
    for (std::uint32_t frame = 0; frame < 3; ++frame) {
        time = bench.light(time, encode_rab(16, 0x1200 + frame),
                           levels({{0, 100}, {4, 200 + static_cast<int>(frame)}, {11, 4000}}));
        bench.read(time + kReadable, 0);
        bench.read(time + kReadable + 0.0005, 20);
        bench.read(time + kReadable + 0.0010, 21, 25);
        bench.read(time + kReadable + 0.0040, 45);
        bench.read(time + kReadable + 0.0045, 46);
        bench.read(time + kReadable + 0.0050, 20);
        time += 0.008;
    }
    bench.run(time);
    for (std::size_t frame = 0; frame < 3; ++frame) {
        const auto* reads = &bench.reads()[6 * frame];
        CHECK(reads[0][0] == 0);
        CHECK(reads[1][0] == 1);
        const auto peak = [&](std::size_t sensor) {  // the first register of a run comes twice
            return reads[2][2 * sensor + 1] << 8 | reads[2][2 * sensor + 2];
        };
        CHECK(peak(0) == 100);
        CHECK(peak(1) == 0);
        CHECK(peak(4) == 200 + static_cast<int>(frame));
        CHECK(peak(11) == 4000);
        CHECK(reads[3][0] == 0x12);
        CHECK(reads[4][0] == frame);
        CHECK(reads[5][0] == 0);
    }
}

TEST_CASE("own RAB firmware: seconds of sending, hearing and polling in all phases lose nothing") {
    RabBench bench(kImage);
    bench.master.clock_hertz = 400e3;
    double time = kReady;
    std::uint32_t heard = 0;
    std::size_t polls = 0;
    std::uint8_t told = 0;
    for (int round = 0; round < 150; ++round) {
        time += 0.0003 + round * 3.1e-6;  // all phases of chips, samples and main loop
        for (int i = 0; i < 3; ++i)
            bench.write(time, {14, ++told});
        time += 0.0272;
        for (int i = 0; i < 2; ++i)
            time = bench.light(time, encode_rab(16, ++heard), levels({{3, 900}, {4, 700}})) + 4 * kChip;
        time += 0.001;
        for (int i = 0; i < 2; ++i, ++polls)
            time = bench.poll(time);
    }
    bench.run(time);
    const auto sent = bench.sent(7);
    CHECK(sent.size() == 450);
    for (std::size_t i = 0; i < sent.size(); ++i)
        CHECK(sent[i].chips == lit_part(encode_rab(16, static_cast<std::uint8_t>(i + 1))));
    for (std::size_t i = 0; i < std::min<std::size_t>(polls, 80); ++i)  // the bench keeps 1000 reads
        CHECK(message(bench, kPollReads * i).data == i + 1);
    CHECK(bench.rig.chip().report().traps.empty());
    CHECK(bench.rig.chip().report().resets.size() == 1);
}
