// The project's own range-and-bearing firmware: boot, registers and what it sends; firmware/rab/README.md
// line by line.

#include "protocols/infrared/rab_frame.h"
#include "tests/firmware/rab_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::firmware;

namespace {

const std::string kImage = std::string(PUCKLOOP_FIRMWARE) + "/rab/rab.hex";
constexpr double kReady = 0.02;  // s

using Bytes = std::vector<std::uint8_t>;

void check_clean(RabBench& bench) {
    const dspic::ChipReport report = bench.rig.chip().report();
    CHECK(report.traps.empty());
    CHECK(report.resets.size() == 1);
    CHECK(report.unmodelled.empty());
}

}  // namespace

TEST_CASE("own RAB firmware: boots, prints it, answers at 0x20 only") {
    for (const std::string& image : {kImage, std::string(PUCKLOOP_FIRMWARE) + "/rab/rab.elf"}) {
        RabBench bench(image);
        for (int i = 0; i < 12; ++i)
            bench.signal(0, "peak" + std::to_string(i + 1), 100 + i);
        bench.write(kReady, {13, 0});
        bench.run(0.08);
        CHECK(bench.rig.take_text(2) ==
              "E-PUCK RANGE AND BEARING STARTED\n\r100 101 102 103 104 105 106 107 108 109 110 111 \n\r");
        CHECK(bench.bus().addresses_refused == 0);
        CHECK(bench.rig.get("carrier") == Approx(454.5e3).epsilon(0.001));
        CHECK(bench.rig.get("power") == 100);
        check_clean(bench);
    }
}

TEST_CASE("own RAB firmware: a range set while it boots is kept") {
    for (const double time : {0.001, 0.003, 0.006, 0.010, 0.015}) {
        RabBench bench(kImage);
        bench.write(time, {12, 37});
        bench.run(0.04);
        if (bench.bus().addresses_refused == 0) CHECK(bench.rig.get("power") == 37);
        if (time >= 0.006) CHECK(bench.bus().addresses_refused == 0);
    }
}

TEST_CASE("own RAB firmware: all emitters send the frame of any payload, 98.1 us a chip") {
    const std::vector<std::pair<int, std::uint32_t>> frames{
        {8, 0x00},        {8, 0x5A},        {8, 0xFF},        {16, 0x0000},     {16, 0x1234},
        {16, 0xA5C3},     {16, 0xFFFF},     {24, 0x010203},   {24, 0x800001},   {24, 0xFFFFFF},
        {32, 0x00000000}, {32, 0x80000000}, {32, 0xDEADBEEF}, {32, 0xFFFFFFFF},
    };
    RabBench bench(kImage);
    double time = kReady;
    for (const auto& [size, payload] : frames) {
        const auto byte = [p = payload](int n) { return static_cast<std::uint8_t>(p >> 8 * n); };
        bench.write(time, {21, static_cast<std::uint8_t>(size)});
        bench.write(time + 0.001, {13, byte(3)});
        bench.write(time + 0.002, {19, byte(2)});
        bench.write(time + 0.003, {20, byte(1)});
        bench.write(time + 0.004, {14, byte(0)});
        time += 0.020;
    }
    bench.run(time);
    for (int emitter = 1; emitter <= 12; ++emitter) {
        const auto sent = bench.sent(emitter);
        REQUIRE(sent.size() == frames.size());
        for (std::size_t i = 0; i < frames.size(); ++i) {
            CHECK(sent[i].chips == lit_part(protocols::encode_rab(frames[i].first, frames[i].second)));
            CHECK(sent[i].chip == Approx(98.1e-6).epsilon(1e-4));
            CHECK(sent[i].jitter < 1.5e-6);
        }
    }
    CHECK(bench.bus().longest_stretch < cosim::from_seconds(20e-6));
    check_clean(bench);
}

TEST_CASE("own RAB firmware: each emitter its own payload, the others dark, forgotten when sent") {
    for (const int size : {8, 16, 24, 32}) {
        RabBench bench(kImage);
        bench.write(kReady, {21, static_cast<std::uint8_t>(size)});
        const std::uint32_t mask = size == 32 ? 0xFFFFFFFF : (1U << size) - 1;
        std::array<std::uint32_t, 12> payloads{};
        for (std::uint32_t i = 0; i < 12; ++i) {
            if (i == 4 || i == 9) continue;
            payloads[i] = (0x9E3779B9 * (i + 1)) & mask;
            const auto byte = [p = payloads[i]](int n) { return static_cast<std::uint8_t>(p >> 8 * n); };
            const double time = kReady + 0.002 + 0.001 * i;
            bench.write(time, {20, byte(3), byte(2), byte(1)});
            bench.write(time, {static_cast<std::uint8_t>(i), byte(0)});
        }
        bench.write(kReady + 0.02, {15, 0});
        bench.write(kReady + 0.04, {15, 0});
        bench.run(kReady + 0.06);
        for (int emitter = 1; emitter <= 12; ++emitter) {
            const auto sent = bench.sent(emitter);
            const bool dark = emitter == 5 || emitter == 10;
            REQUIRE(sent.size() == (dark ? 0 : 1));
            if (dark) continue;
            CHECK(sent[0].chips ==
                  lit_part(protocols::encode_rab(size, payloads[static_cast<std::size_t>(emitter - 1)])));
        }
    }
}

TEST_CASE("own RAB firmware: ten frames wait beside the one on the air, 27 free chips and more apart") {
    RabBench bench(kImage);
    bench.master.clock_hertz = 400e3;
    for (int i = 0; i < 14; ++i)
        bench.write(kReady, {14, static_cast<std::uint8_t>(i)});
    bench.run(kReady + 0.25);
    const auto sent = bench.sent(1);
    REQUIRE(sent.size() == 11);
    for (std::size_t i = 0; i < sent.size(); ++i) {
        CHECK(sent[i].chips == lit_part(protocols::encode_rab(16, static_cast<std::uint32_t>(i))));
        if (i == 0) continue;
        const double dark = sent[i].start - sent[i - 1].start - 46 * kChip;
        CHECK(dark > 26 * kChip);
        CHECK(dark < 61 * kChip);
    }
}

TEST_CASE("own RAB firmware: a new payload size leaves the frame on the air alone and forgets the others") {
    for (int chip = 5; chip < 80; chip += 7) {
        RabBench bench(kImage);
        bench.write(kReady, {21, 32});
        bench.write(kReady, {20, 0xDE, 0xAD, 0xBE});
        bench.write(kReady, {14, 0xEF});
        bench.write(kReady, {14, 0x00});
        bench.write(kReady + 0.0025 + chip * kChip, {21, 8});
        bench.write(kReady + 0.015, {14, 0xA5});
        bench.run(kReady + 0.03);
        const auto sent = bench.sent(1);
        INFO(chip);
        REQUIRE(sent.size() == 2);
        CHECK(sent[0].chips == lit_part(protocols::encode_rab(32, 0xDEADBEEF)));
        CHECK(sent[1].chips == lit_part(protocols::encode_rab(8, 0xA5)));
    }
}

TEST_CASE("own RAB firmware: sizes, unknown registers and runs of registers as in the original") {
    RabBench bench(kImage);
    bench.write(kReady, {21, 7});
    bench.write(kReady, {14, 1});
    bench.write(kReady + 0.01, {21, 8, 16, 24});
    bench.write(kReady + 0.01, {13, 0});
    bench.write(kReady + 0.01, {14, 1});
    bench.write(kReady + 0.02, {99, 1});
    bench.read(kReady + 0.02, 99, 3);
    bench.run(kReady + 0.04);
    const auto sent = bench.sent(12);
    REQUIRE(sent.size() == 2);
    CHECK(sent[0].chips == lit_part(protocols::encode_rab(16, 1)));
    CHECK(sent[1].chips == lit_part(protocols::encode_rab(24, 1)));
    CHECK(bench.reads()[0] == Bytes{0, 0, 0});
    check_clean(bench);
}

TEST_CASE("own RAB firmware: a range set in mid-frame disturbs no emitter") {
    RabBench bench(kImage);
    bench.write(kReady, {14, 0x5A});
    for (int i = 0; i < 12; ++i)
        bench.write(kReady + 0.0007 + 0.0003 * i, {12, static_cast<std::uint8_t>(i)});
    bench.run(kReady + 0.01);
    for (int emitter = 1; emitter <= 12; ++emitter) {
        const auto sent = bench.sent(emitter);
        REQUIRE(sent.size() == 1);
        CHECK(sent[0].chips == lit_part(protocols::encode_rab(16, 0x5A)));
        CHECK(sent[0].jitter < 2e-6);
    }
    CHECK(bench.rig.get("power") == 11);
}

TEST_CASE("own RAB firmware: polls at any time do not touch the frame being sent") {
    RabBench bench(kImage);
    bench.write(kReady, {13, 0xA5});
    bench.write(kReady, {14, 0xC3});
    for (int i = 0; i < 30; ++i)
        bench.read(kReady + 0.001 + 0.0002 * i, 0);
    bench.run(kReady + 0.02);
    const auto sent = bench.sent(3);
    REQUIRE(sent.size() == 1);
    CHECK(sent[0].chips == lit_part(protocols::encode_rab(16, 0xA5C3)));
    CHECK(sent[0].jitter < 1.5e-6);
    CHECK(bench.bus().longest_stretch < cosim::from_seconds(20e-6));
}

TEST_CASE("own RAB firmware: while it hears a frame it keeps its own back, ten milliseconds at most") {
    const std::string heard = protocols::encode_rab(16, 0x1234);
    RabBench polite(kImage);
    const double end = polite.light(kReady, heard, levels({{3, 1000}}));
    polite.write(kReady + 0.001, {14, 1});
    polite.run(kReady + 0.03);
    REQUIRE(polite.sent(1).size() == 1);
    CHECK(polite.sent(1)[0].start > end + 25 * kChip);
    CHECK(polite.sent(1)[0].start < end + 62 * kChip);
    RabBench busy(kImage);  // frame after frame by others
    double time = kReady;
    while (time < kReady + 0.02)
        time = busy.light(time, heard, levels({{3, 1000}})) + 5 * kChip;
    busy.write(kReady + 0.001, {14, 1});
    busy.run(kReady + 0.03);
    REQUIRE(busy.sent(1).size() == 1);
    CHECK(busy.sent(1)[0].start == Approx(kReady + 0.0115).margin(0.0005));
}

TEST_CASE("own RAB firmware: a sensor in the sun delays nothing") {
    RabBench bench(kImage);
    bench.signal(kReady - 0.010, "demod4", 1);
    bench.write(kReady, {14, 1});
    bench.run(kReady + 0.01);
    REQUIRE(bench.sent(1).size() == 1);
    CHECK(bench.sent(1)[0].start < kReady + 0.001);
}
