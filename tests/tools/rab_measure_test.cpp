// Range and bearing measured on emulated boards: the figures, the picture, the master on the bus, and a short
// measurement with a real image where there is one.

#include "base/error.h"
#include "reproductions/rab/i2c_host.h"
#include "reproductions/rab/measure.h"
#include "reproductions/rab/picture.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstdlib>
#include <numbers>

using namespace puckloop;
using namespace puckloop::tools;
using cosim::I2cPhaseKind;
using cosim::kMicrosecond;
using cosim::kNever;
using cosim::Time;

TEST_CASE("readings become medians, spreads and bearing errors that wrap") {
    std::vector<RabReadingRow> rows;
    for (int i = -50; i <= 50; ++i) {
        RabReadingRow row;
        row.distance = 1;
        row.received = true;
        row.late = i == 0;
        row.range = 1000 + i;
        row.bearing_true = std::numbers::pi - 0.01;
        row.bearing = -std::numbers::pi + 0.01;  // 0.02 rad further
        rows.push_back(row);
    }
    rows.push_back({.distance = 1});
    const auto all = summarise(rows, {0.02, 0.10});
    REQUIRE(all.size() == 2);
    CHECK(all[0].sent == 0);
    CHECK(all[1].sent == 102);
    CHECK(all[1].received == 101);
    CHECK(all[1].late == 1);
    CHECK(all[1].strength.median == 1000);
    CHECK(all[1].strength.p10 == 960);
    CHECK(all[1].strength.p90 == 1040);
    CHECK(all[1].sigma == Approx(0.0292).epsilon(0.01));
    CHECK(all[1].bearing_error.median == Approx(0.02 * 180 / std::numbers::pi));
    CHECK(all[1].bearing_rms == Approx(0.02 * 180 / std::numbers::pi));
    const auto csv = summary_csv(all);
    CHECK_THAT(csv, Catch::Contains("\n2,0,0,0,0,") &&
                        Catch::Contains("\n10,102,101,1,0,1000,0.029,960,1040,1193,0.153,"));
    const auto svg = rab_picture(all, "two columns");
    CHECK_THAT(svg,
               Catch::StartsWith("<svg ") && Catch::EndsWith("</svg>\n") && Catch::Contains("99 % read"));
    CHECK_THAT(svg, !Catch::Contains("nan") && !Catch::Contains("inf"));
}

TEST_CASE("the master waits for each answer and ends with STOP") {
    I2cHost host(0x20, 100e3);
    std::optional<std::uint8_t> got;
    host.read(1000 * kMicrosecond, 5, [&got](std::optional<std::uint8_t> byte, Time) { got = byte; });
    struct Expected {
        I2cPhaseKind kind;
        int byte;
        Time at;
    };
    const Expected phases[] = {{I2cPhaseKind::Start, 0x40, 1000},
                               {I2cPhaseKind::Write, 5, 1090},
                               {I2cPhaseKind::Start, 0x41, 1180},
                               {I2cPhaseKind::Read, 0, 1270}};
    for (const auto& expected : phases) {
        REQUIRE(host.due() == expected.at * kMicrosecond);
        auto phase = host.next();
        CHECK(phase.kind == expected.kind);
        if (expected.kind != I2cPhaseKind::Read) CHECK(phase.byte == expected.byte);
        CHECK(host.due() == kNever);
        phase.ack = 1;
        phase.byte = 0x77;
        // The last byte is stretched by a millisecond.
        const Time stretch = expected.kind == I2cPhaseKind::Read ? 1000 : 0;
        host.answered(phase, (expected.at + 80 + stretch) * kMicrosecond);
    }
    CHECK(host.due() == 2360 * kMicrosecond);
    CHECK(host.next().kind == I2cPhaseKind::Stop);
    CHECK(got == 0x77);
    CHECK(host.due() == kNever);
}

TEST_CASE("a refused byte ends the transfer and is reported") {
    I2cHost host(0x20, 400e3);
    bool told = false;
    host.read(0, 5, [&told](std::optional<std::uint8_t> byte, Time) { told = !byte; });
    auto phase = host.next();
    phase.ack = 0;
    host.answered(phase, 20 * kMicrosecond);
    CHECK(host.next().kind == I2cPhaseKind::Stop);
    CHECK(told);
    CHECK(host.refused() == 1);
}

TEST_CASE("the stage gives when it will send next") {
    std::vector<RabReadingRow> rows;
    StagePlan plan;
    plan.distances = {0.1};
    plan.repeats = 1;
    StageNode stage(plan, rows);
    CHECK(stage.earliest_output(1) == 92 * cosim::kMillisecond);
    CHECK(stage.earliest_output(0) == 100 * cosim::kMillisecond);
    CHECK(stage.lookahead(0) == kNever);
    std::vector<cosim::Message> out;
    stage.advance(200 * cosim::kMillisecond, {}, out);  // nobody answers: poses, and one Start a bus
    CHECK(out.size() == 6 + 2);
    CHECK(stage.earliest_output(0) == kNever);
    CHECK(stage.earliest_output(1) == kNever);
    CHECK(rows.size() == 2);
}

TEST_CASE("two boards with the real firmware read each other at a hand's breadth") {
    const char* images = std::getenv("PUCKLOOP_IMAGES");
    if (images == nullptr) {
        WARN("skipped: PUCKLOOP_IMAGES is not set");
        return;
    }
    RabMeasurement what;
    what.firmware = std::filesystem::path(images) / "randb.hex";
    what.distances = {0.10};
    what.pairs = 1;
    what.repeats = 3;
    for (const char* name : {"ir.emitter_spread", "ir.receiver_spread", "ir.demodulator_spread",
                             "ir.frame_noise", "ir.receiver_noise", "ir.carrier_noise", "ir.near_noise"})
        what.parameters[name] = 0.0;
    const auto measured = measure_rab(
        what, [](double) {}, nullptr);
    REQUIRE(measured.rows.size() == 6);
    for (const auto& row : measured.rows) {
        CHECK(row.received);
        CHECK_FALSE(row.late);
        CHECK(row.strays == 0);
        CHECK(row.range == Approx(1193).epsilon(0.15));  // the curve, and what the heading does to it
        CHECK(std::abs(std::remainder(row.bearing - row.bearing_true, 2 * std::numbers::pi)) < 0.12);
    }
}
