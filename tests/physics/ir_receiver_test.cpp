// Receivers in time: delays, bursts and gaps that are too short, levels that hold.

#include "physics/ir/ir_receiver.h"

#include <catch2/catch.hpp>

using namespace puckloop::physics;
using puckloop::cosim::kMicrosecond;
using puckloop::cosim::kNever;
using puckloop::cosim::Time;

namespace {

IrLight light(float carrier, float level) {
    IrLight all;
    all.carrier[3] = carrier;
    all.level[3] = level;
    return all;
}

struct Bench {
    explicit Bench(const IrParameters& p) : receiver(p) {
        receiver.see(0, IrLight{});
        until(100);
        got.clear();
    }
    void see(Time microseconds, float carrier, float level = 0.0F) {
        receiver.run_to(microseconds * kMicrosecond);
        receiver.see(microseconds * kMicrosecond, light(carrier, level));
    }
    void until(Time microseconds) {
        receiver.run_to(microseconds * kMicrosecond);
        receiver.release(microseconds * kMicrosecond, got);
    }
    IrReceiver receiver;
    std::vector<IrOutput> got;
};

IrParameters parameters() {
    IrParameters p = Parameters().ir;
    p.delay_on = 20e-6;
    p.delay_off = 8e-6;
    p.min_burst = 10e-6;
    p.min_gap = 5e-6;
    p.level_delay = 12e-6;
    p.level_hold = 350e-6;
    return p;
}

void check_output(const IrOutput& output, Time microseconds, int index, double value) {
    CHECK(output.time == microseconds * kMicrosecond);
    CHECK(output.index == index);
    CHECK(output.value == value);
}

}  // namespace

TEST_CASE("a burst shows after the delay on and goes after the delay off") {
    Bench bench(parameters());
    bench.see(1000, 1.0F);  // just at the threshold
    CHECK(bench.receiver.next_output() == 1020 * kMicrosecond);
    bench.see(1100, 0.99F);
    bench.until(2000);
    REQUIRE(bench.got.size() == 2);
    check_output(bench.got[0], 1020, 3, 1.0);
    check_output(bench.got[1], 1108, 3, 0.0);
    CHECK(bench.receiver.next_output() == kNever);
    CHECK(bench.receiver.lookahead() == 8 * kMicrosecond);
}

TEST_CASE("too short a burst is not seen, nor is too short a gap") {
    Bench bench(parameters());
    bench.see(1000, 2.0F);
    bench.see(1009, 0.0F);
    bench.until(1500);
    CHECK(bench.got.empty());
    bench.see(2000, 2.0F);
    bench.see(2010, 0.0F);  // just long enough
    bench.see(3000, 2.0F);
    bench.see(3100, 0.0F);
    bench.see(3104, 2.0F);
    bench.see(3200, 0.0F);
    bench.until(4000);
    REQUIRE(bench.got.size() == 4);
    check_output(bench.got[0], 2020, 3, 1.0);
    CHECK(bench.got[1].time == 2020 * kMicrosecond + 1);  // its end would be due before: no pulse to speak of
    CHECK(bench.got[1].value == 0.0);
    check_output(bench.got[2], 3020, 3, 1.0);
    check_output(bench.got[3], 3208, 3, 0.0);
}

TEST_CASE("levels rise at once and fall after the hold") {
    Bench bench(parameters());
    bench.see(1000, 0.0F, 800.4F);
    bench.see(1100, 0.0F, 100.0F);
    bench.see(1200, 0.0F, 800.0F);  // back in time: nothing happened
    bench.see(1300, 0.0F, 100.0F);
    bench.see(1500, 0.0F, 120.0F);
    bench.until(1649);
    REQUIRE(bench.got.size() == 1);
    check_output(bench.got[0], 1012, kIrLevelOutput + 3, 800.0);
    CHECK(bench.receiver.next_output() == 1662 * kMicrosecond);
    bench.see(3000, 0.0F, 9000.0F);
    bench.until(4000);
    REQUIRE(bench.got.size() == 3);
    check_output(bench.got[1], 1662, kIrLevelOutput + 3, 120.0);
    check_output(bench.got[2], 3012, kIrLevelOutput + 3, 4095.0);
}

TEST_CASE("nothing is released that could still change") {
    Bench bench(parameters());
    bench.see(1000, 2.0F);
    bench.until(1009);
    CHECK(bench.got.empty());
    bench.until(1019);
    REQUIRE(bench.got.size() == 1);  // decided at 1010, due at 1020
    check_output(bench.got[0], 1020, 3, 1.0);
}

namespace {

IrParameters with_gain_control() {
    IrParameters p = parameters();
    p.gain_share = 0.5;
    p.gain_hold = 300e-6;
    return p;
}

}  // namespace

TEST_CASE("a strong carrier hides weak ones until its hold is over") {
    Bench bench(with_gain_control());
    bench.see(1000, 4.0F);
    bench.see(1500, 1.9F);  // less than half of it
    CHECK(bench.receiver.next_output() <= 1508 * kMicrosecond);
    bench.until(1700);
    REQUIRE(bench.got.size() == 2);
    check_output(bench.got[0], 1020, 3, 1.0);
    check_output(bench.got[1], 1508, 3, 0.0);
    CHECK(bench.receiver.next_output() <= 1820 * kMicrosecond);
    bench.until(2000);
    REQUIRE(bench.got.size() == 3);
    check_output(bench.got[2], 1820, 3, 1.0);

    // Half of it is enough at once; what is alone needs the plain threshold.
    Bench half(with_gain_control());
    half.see(1000, 4.0F);
    half.see(1500, 2.0F);
    half.until(2000);
    CHECK(half.got.size() == 1);
    Bench alone(with_gain_control());
    alone.see(1000, 1.0F);
    alone.until(1100);
    REQUIRE(alone.got.size() == 1);
    check_output(alone.got[0], 1020, 3, 1.0);
}

TEST_CASE("a frame's dark chips are shorter than the hold: a weak sender stays hidden") {
    Bench bench(with_gain_control());
    for (Time chip = 1000; chip < 3000; chip += 200) {  // strong on, weak alone, by turns
        bench.see(chip, 5.0F);
        bench.see(chip + 100, 1.5F);
    }
    bench.until(3000);
    REQUIRE(bench.got.size() == 20);
    for (std::size_t i = 0; i < bench.got.size(); ++i)
        CHECK(bench.got[i].value == (i % 2 == 0 ? 1.0 : 0.0));
    bench.until(3300);  // the hold ends at 3200
    REQUIRE(bench.got.size() == 21);
    check_output(bench.got.back(), 3220, 3, 1.0);
}

TEST_CASE("without gain control nothing but the threshold counts") {
    Bench bench(parameters());
    bench.see(1000, 40.0F);
    bench.see(1500, 1.0F);
    bench.until(3000);
    CHECK(bench.got.size() == 1);
}
