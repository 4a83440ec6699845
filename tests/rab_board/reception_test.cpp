// What the real image makes of light: range-and-bearing fact sheet 4, 6.3 A8 to A10, A15, 2.2, 4.7, 4.8 Q5,
// Q7.

#include "protocols/infrared/rab_frame.h"
#include "tests/rab_board/rab_rig.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace puckloop;
using protocols::encode_rab;
using rab::kChip;
using rab::RabRig;
using rab::Seen;

namespace {

constexpr double kLead = 0.0005;   // s, from "now" to a frame's first chip
constexpr double kSettle = 0.012;  // s, from a frame's first chip until its message is read
constexpr int kAmbient = 200;

struct Ready {
    RabRig rig;
    explicit Ready(const std::string& file, double i2c_hertz = 100e3) : rig(file, i2c_hertz) {
        rig.ambient(kAmbient);
        rig.boot();
    }
    /// Shows chips on one sensor and waits.
    void show(const std::string& chips, int peak = 1500, int sensor = 0) {
        rig.show(rig.now_s() + kLead, chips, {{sensor, peak}});
        rig.run_for(kLead + kSettle);
    }
    void show(std::uint32_t payload, int peak = 1500, int sensor = 0) {
        show(encode_rab(16, payload), peak, sensor);
    }
    /// Nothing, or the data of the one message that waits.
    std::optional<std::uint32_t> data() {
        const auto message = rig.poll();
        return message ? std::optional(message->data) : std::nullopt;
    }
};

struct Golden {
    std::vector<Seen> seen;
    int bearing, range, peak, sensor;
};

/// Fact sheet 4.4.
const std::vector<Golden>& golden() {
    static const std::vector<Golden> list = [] {
        std::vector<Golden> all{
            {{{0, 1000}, {1, 550}, {11, 600}}, 2696, 1041, 1000, 0},
            {{{0, 1500}, {1, 800}, {11, 900}}, 2648, 1561, 1500, 0},
            {{{0, 1000}, {11, 1000}}, 0, 1210, 1000, 0},
            {{{0, 1000}, {1, 500}}, 4625, 1027, 1000, 0},
            {{{0, 500}, {1, 1000}}, 6719, 1027, 1000, 1},
            {{{5, 900}, {6, 900}}, 30892, 1097, 900, 5},
            {{{5, 1000}, {6, 400}}, 29508, 1015, 1000, 5},
            {{{5, 300}, {6, 2000}, {7, 1500}}, -27192, 2170, 2000, 6},
            {{{2, 1200}, {3, 1200}}, 0, 2805, 1200, 2},
            {{{2, 1000}, {8, 1000}}, 0, 2337, 1000, 2},
            {{{7, 2000}, {8, 4095}, {9, 4095}}, -17352, 4975, 4095, 8},
            {{{9, 700}, {10, 650}}, -11171, 815, 700, 9},
            {{{0, 2400}, {1, 500}, {10, 600}, {11, 2500}}, -188, 2966, 2500, 11},
            {{{0, 4095}, {6, 4095}}, 0, 4954, 4095, 0},
            {{{4, 1991}, {5, 1117}, {6, 858}}, 26730, 2098, 1991, 4},
            {{{7, 242}, {8, 1997}, {9, 1243}}, -16935, 2085, 1997, 8},
            {{{0, 542}, {1, 871}, {2, 1178}}, 9509, 1290, 1178, 2},
            {{{3, 0}}, 0, 0, 0, 0},
        };
        const int alone[] = {2617,   8726,   13089,  18325,  23212, 27750,
                             -28797, -23561, -18325, -13439, -8726, -2617};
        for (int i = 0; i < 12; ++i)
            all.push_back({{{i, 4095}}, alone[i], 4095, 4095, i});
        return all;
    }();
    return list;
}

}  // namespace

TEST_CASE("A8: a frame on three sensors, register by register") {
    const auto file = exec::real_image(GENERATE(as<std::string>(), rab::kRandb, rab::kErab));
    if (!file) return;
    Ready board(*file);
    RabRig& rig = board.rig;
    rig.show(rig.now_s() + kLead, encode_rab(16, 0x1234), {{0, 1500}, {1, 800}, {11, 900}});
    rig.run_for(kLead + kSettle);
    const int expected[] = {1, 0x12, 0x34, 0x0A, 0x58, 0x06, 0x19, 0x05, 0xDC, 0};
    for (int number = 0; number < 10; ++number) {
        INFO("register " << number);
        CHECK(rig.get(number) == expected[number]);
    }
    CHECK(rig.get(0) == 0);
    CHECK(rig.get16(1) == 0x1234);  // the private copy stays
}

TEST_CASE("4.4: peaks make bearing and range") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    RabRig rig(*file);
    rig.boot();  // no ambient light: a peak may reach 4095
    for (const Golden& vector : golden()) {
        rig.show(rig.now_s() + kLead, encode_rab(16, 0xBEEF), vector.seen);
        rig.run_for(kLead + kSettle);
        const auto message = rig.poll();
        INFO("first sensor " << vector.seen[0].sensor << " at " << vector.seen[0].peak << " of "
                             << vector.seen.size());
        REQUIRE(message);
        CHECK(message->data == 0xBEEF);
        CHECK(message->bearing == vector.bearing);
        CHECK(message->range == vector.range);
        CHECK(message->peak == vector.peak);
        CHECK(message->sensor == vector.sensor);
    }
}

TEST_CASE("A9: the peak detectors are reset in the preamble, all twelve") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    Ready board(*file);
    RabRig& rig = board.rig;
    const double first_edge = rig.now_s() + kLead + 8e-6;
    rig.clear();
    board.show(0x1234);
    for (int i = 1; i <= 12; ++i) {
        const auto pulses = rig.changes(fmt::format("peak_reset{}", i));
        INFO("peak_reset" << i);
        REQUIRE(pulses.size() == 2);
        CHECK(pulses[0].value == 1);
        // Samples 3 and 5; the sheet's 262 to 458 us are one phase of the sampler out of a chip.
        CHECK(pulses[0].time_s - first_edge > 2 * kChip);
        CHECK(pulses[0].time_s - first_edge < 3.1 * kChip);
        CHECK(pulses[1].time_s - pulses[0].time_s == Approx(2 * kChip).epsilon(0.02));
    }
}

TEST_CASE("A10: of 13 frames that nobody fetches the first 10 stay, in order") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    Ready board(*file);
    for (std::uint32_t i = 1; i <= 13; ++i)
        board.show(0x1100 + i);
    for (std::uint32_t i = 1; i <= 10; ++i)
        CHECK(board.data() == 0x1100 + i);
    CHECK_FALSE(board.data());
}

TEST_CASE("all payload sizes are received") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    Ready board(*file);
    for (const int size : protocols::kRabSizes) {
        board.rig.write(21, {static_cast<std::uint8_t>(size)});
        for (const std::uint32_t payload : {0x00u, 0xFFFFFFFFu, 0xDEADBEEFu, 0x12345678u}) {
            const std::uint32_t data = size == 32 ? payload : payload & ((1u << size) - 1);
            board.show(encode_rab(size, data));
            INFO(size << " bits");
            CHECK(board.data() == data);
        }
    }
}

TEST_CASE("2.2: the register pointer's rules") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    Ready board(*file);
    RabRig& rig = board.rig;
    board.show(0x1122);
    REQUIRE(board.data() == 0x1122);
    // r, r, r+1, r+2: off by one after the first byte.
    CHECK(rig.read(1, 4) ==
          std::vector<std::uint8_t>{0x11, 0x11, 0x22, static_cast<std::uint8_t>(rig.get(3))});
    // The pointer stays from one transfer to the next, and so does the count of bytes read since it was
    // written.
    rig.write(12, {100});
    CHECK(rig.read(1) == std::vector<std::uint8_t>{0x11});
    CHECK(rig.read_on(1) == std::vector<std::uint8_t>{0x11});
    CHECK(rig.read_on(1) == std::vector<std::uint8_t>{0x11});
    rig.read(1, 2);
    const std::uint8_t bearing = static_cast<std::uint8_t>(rig.get(3));
    rig.read(1, 2);
    CHECK(rig.read_on(2) == std::vector<std::uint8_t>{0x11, 0x22});
    CHECK(rig.read_on(2) == std::vector<std::uint8_t>{0x11, bearing});
    // A poll of two bytes takes two messages.
    board.show(0x0001);
    board.show(0x0002);
    board.show(0x0003);
    CHECK(rig.read(0, 2) == std::vector<std::uint8_t>{1, 1});
    CHECK(rig.get16(1) == 0x0002);
    CHECK(board.data() == 0x0003);
    CHECK_FALSE(board.data());
    // What is written goes to one register; what does not exist reads 0.
    CHECK(rig.get(99) == 0);
    CHECK(rig.get(255) == 0);
    rig.write(99, {1, 2, 3});
    rig.write(2, {0x77});  // a payload for emitter 2, not the data that was received
    CHECK(rig.get(2) == 0x03);
}

TEST_CASE("A15: a receiver polled each millisecond while a frame is on air loses most of them") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    Ready board(*file);
    int received = 0;
    constexpr int kFrames = 12;
    for (int i = 0; i < kFrames; ++i) {
        const double start = board.rig.now_s() + kLead + i * 83e-6;
        board.rig.show(start, encode_rab(16, 0x1234), {{0, 1500}});
        std::string script;
        for (int k = 0; k < 6; ++k)
            script += fmt::format("{:.9f} r 0x20 0 1\n", start + k * 1e-3);
        board.rig.play(script);
        board.rig.run_for(0.02);
        while (board.data())
            ++received;
        board.show("");
    }
    CHECK(received <= kFrames / 3);
}

TEST_CASE("4.7: noise of up to four samples is ignored") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    for (int length = 1; length <= 4; ++length) {
        Ready board(*file);
        board.show(std::string(static_cast<std::size_t>(length), '1'), 3000, 4);
        board.show(0x1234, 1500);
        const auto message = board.rig.poll();
        INFO(length << " samples");
        REQUIRE(message);
        CHECK(message->peak == 1500);
    }
}

TEST_CASE("4.7: five, six or eight samples of noise leave their peaks to the next message") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    for (const std::size_t length : {5u, 6u, 8u}) {
        Ready board(*file);
        board.show(std::string(length, '1'), 3000);
        CHECK_FALSE(board.data());
        board.show(0x1234, 1500);
        auto message = board.rig.poll();
        INFO(length << " samples");
        REQUIRE(message);
        CHECK(message->data == 0x1234);
        CHECK(message->peak == 3000);
    }
}

TEST_CASE("4.7: seven samples of noise cost the next frame") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    Ready board(*file);
    board.show("1111111");
    board.show(0x1234);
    CHECK_FALSE(board.data());
    board.show(0x5678);
    CHECK(board.data() == 0x5678);
}

TEST_CASE("4.7: after a Manchester violation the next message carries the peaks of the broken frame") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    Ready board(*file);
    std::string broken = encode_rab(16, 0x1234);
    broken[20] = broken[21] = '1';
    board.show(broken, 1500);
    CHECK_FALSE(board.data());
    board.show(0x1234, 2000);
    auto message = board.rig.poll();
    REQUIRE(message);
    CHECK(message->data == 0x1234);
    CHECK(message->peak == 1500);
    board.show(0x1234, 2000);
    message = board.rig.poll();
    REQUIRE(message);
    CHECK(message->peak == 2000);
}

TEST_CASE("4.7: a frame cut off costs the next one, and the one after it carries stale peaks") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    Ready board(*file);
    board.show(encode_rab(16, 0x1234).substr(0, 25), 1500);
    CHECK_FALSE(board.data());
    board.show(0x2222, 1700);
    CHECK_FALSE(board.data());
    board.show(0x3333, 2000);
    const auto message = board.rig.poll();
    REQUIRE(message);
    CHECK(message->data == 0x3333);
    CHECK(message->peak != 2000);
}

TEST_CASE("4.7: a wrong check that ends in an off chip costs the next frame") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    Ready board(*file);
    std::string wrong = encode_rab(16, 0x1234);  // check B: ends 10 01 10 10, off
    REQUIRE(wrong.ends_with("10011010"));
    wrong.replace(wrong.size() - 8, 2, "01");
    board.show(wrong);
    CHECK_FALSE(board.data());
    board.show(0x5555);
    CHECK_FALSE(board.data());
    board.show(0x6666);
    CHECK(board.data() == 0x6666);
}

TEST_CASE("4.7: a wrong check that ends in an on chip leaves nothing but its peaks") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    Ready board(*file);
    std::string wrong = encode_rab(16, 0x0B9B);  // check 8: ends 10 01 01 01, on
    REQUIRE(wrong.ends_with("10010101"));
    wrong.replace(wrong.size() - 8, 2, "01");
    board.show(wrong, 900);
    CHECK_FALSE(board.data());
    board.show(0x5555, 1500);
    auto message = board.rig.poll();
    REQUIRE(message);
    CHECK(message->data == 0x5555);
    CHECK(message->peak == 900);
    board.show(0x6666, 1500);
    message = board.rig.poll();
    REQUIRE(message);
    CHECK(message->peak == 1500);
}

TEST_CASE(
    "4.7: a receiver lit from the first sample on drops out, the others' message arrives once it is dark") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    Ready board(*file);
    const double start = board.rig.now_s() + kLead, dark = start + 0.02;
    board.rig.show(start, encode_rab(16, 0x1234), {{0, 1500}});
    board.rig.show(start, std::string(1, '1'), {{6, 100}}, dark - start);
    board.rig.run_to(dark - 0.001);
    CHECK_FALSE(board.data());
    board.rig.run_to(dark + 0.01);
    const auto message = board.rig.poll();
    REQUIRE(message);
    CHECK(message->data == 0x1234);
    CHECK(message->sensor == 0);
}

TEST_CASE(
    "4.7: two payloads on one receiver spoil it, a receiver that sees one of them only still delivers it") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    Ready board(*file);
    const std::string one = encode_rab(16, 0x1234), other = encode_rab(16, 0x4321);
    std::string both = one;
    for (std::size_t i = 0; i < both.size(); ++i)
        if (other[i] == '1') both[i] = '1';
    const double start = board.rig.now_s() + kLead;
    board.rig.show(start, one, {{0, 1500}});
    board.rig.show(start, both, {{1, 2000}});
    board.rig.run_for(0.02);
    CHECK(board.data() == 0x1234);
    const double again = board.rig.now_s() + kLead;
    board.rig.show(again, both, {{1, 2000}});
    board.rig.run_for(0.02);
    CHECK_FALSE(board.data());
}

TEST_CASE("4.7: payload sizes that differ") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    struct Mismatch {
        int sent;
        std::uint32_t payload;
        int receiver;
        std::optional<std::uint32_t> result;
    };
    const Mismatch mismatch =
        GENERATE(Mismatch{8, 0x5A, 16, std::nullopt}, Mismatch{16, 0x1234, 32, std::nullopt},
                 Mismatch{16, 0x005A, 8, 0x5A}, Mismatch{32, 0x5A, 16, 0x005A});
    INFO(mismatch.sent << " bits on a receiver for " << mismatch.receiver);
    Ready board(*file);
    board.rig.write(21, {static_cast<std::uint8_t>(mismatch.receiver)});
    board.show(encode_rab(mismatch.sent, mismatch.payload));
    CHECK(board.data() == mismatch.result);
    board.show(encode_rab(mismatch.receiver, 0x33));
    const auto next = board.data();
    if (!next) board.show(encode_rab(mismatch.receiver, 0x33));
    CHECK((next ? next : board.data()) == 0x33);
}

TEST_CASE("4.7: a second sender on other sensors does not harm the first, and is lost") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    const double chips_later = GENERATE(1.5, 7.0, 30.0, 60.0);
    Ready board(*file);
    const double start = board.rig.now_s() + kLead;
    board.rig.show(start, encode_rab(16, 0x1234), {{0, 1500}});
    board.rig.show(start + chips_later * kChip, encode_rab(16, 0xAAAA), {{6, 1000}});
    board.rig.run_for(0.03);
    INFO(chips_later << " chips later");
    const auto message = board.rig.poll();
    REQUIRE(message);
    CHECK(message->data == 0x1234);
    CHECK(message->sensor == 0);
    CHECK_FALSE(board.data());
}

TEST_CASE("4.7: two frames a good while apart are both delivered") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    Ready board(*file);
    const double start = board.rig.now_s() + kLead;
    board.rig.show(start, encode_rab(16, 0x1234), {{0, 1500}});
    board.rig.show(start + 74 * kChip, encode_rab(16, 0xAAAA), {{6, 1000}});
    board.rig.run_for(0.03);
    CHECK(board.data() == 0x1234);
    CHECK(board.data() == 0xAAAA);
}

TEST_CASE("4.2: aligned frames on different sensors: the higher sensor's data, the stronger one's peak") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    Ready board(*file);
    const double start = board.rig.now_s() + kLead;
    board.rig.show(start, encode_rab(16, 0x1234), {{0, 2000}});
    board.rig.show(start, encode_rab(16, 0xAAAA), {{1, 500}});
    board.rig.run_for(0.02);
    const auto message = board.rig.poll();
    REQUIRE(message);
    CHECK(message->data == 0xAAAA);
    CHECK(message->peak == 2000);
    CHECK(message->sensor == 0);
}

TEST_CASE("4.7: light on one sensor from before the preamble costs the message") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    Ready board(*file);
    board.rig.later(board.rig.now_s() + kLead - 20 * kChip, "demod7", 1);
    board.show(0x1234);
    CHECK_FALSE(board.data());
}

TEST_CASE("Q5: baselines read anew take the last frame's peaks for ambient light") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    Ready board(*file);
    board.show(0x1111, 1500);
    REQUIRE(board.data() == 0x1111);
    board.rig.write(16, {0});
    board.rig.run_for(0.005);
    board.show(0x2222, 1500);
    const auto message = board.rig.poll();
    REQUIRE(message);
    CHECK(message->data == 0x2222);
    CHECK(message->peak <= 1);
    CHECK(message->range <= 1);
}

TEST_CASE("Q7: in raw-peak mode a frame that ends in an off chip costs the next one") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    Ready board(*file);
    RabRig& rig = board.rig;
    rig.write(17, {1});
    std::vector<int> received;
    for (int i = 0; i < 3; ++i) {
        board.show(0x1234, 1500);  // ends 10
        rig.run_for(0.02);         // it prints twelve numbers
        const bool here = rig.get(20) == 1;
        received.push_back(here ? 1 : 0);
        if (!here) continue;
        CHECK(rig.get16(21) == 1500);
        CHECK(rig.get16(23) == 0);
        CHECK(rig.get(45) == 0x12);
        CHECK(rig.get(20) == 1);
        CHECK(rig.get(46) == 0x34);  // clears
        CHECK(rig.get(20) == 0);
    }
    CHECK(received == std::vector<int>{1, 0, 1});
    CHECK_FALSE(rig.bench().take_text(2).empty());
}
