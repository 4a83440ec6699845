#include "gap/selftest/effect_lists.h"

#include <cmath>

namespace puckloop::gap::selftest {

namespace {
using Truths = std::vector<Truth>;
using K = TimingKnobs;
}  // namespace

std::unique_ptr<Bench> timing_bench() {
    // clang-format off
    return std::make_unique<BenchOf<K>>(timing_rig(), std::vector<HiddenEffect<K>>{
        {57, "stretched I2C", 0.002, false, [](K& k, double a, RandomStream) { k.i2c_stretch = a; return Truths{{"timing.i2c_stretch", a}}; }},
        {58, "baud mismatch", 0.1, false, [](K& k, double a, RandomStream) { k.baud_error = a; return Truths{{"timing.edge_errors", 4 * (a - 0.02)}}; },
            std::array{0.0205, 0.021, 0.025}},
        {59, "FIFO overrun", 1.0, false, [](K& k, double a, RandomStream) { k.overrun = a; return Truths{{"timing.overrun", a}}; },
            std::array{0.03, 0.1, 0.4}},
        {60, "cut frames", 1.0, false, [](K& k, double a, RandomStream) { k.truncated = a; return Truths{{"timing.truncation", a}}; },
            std::array{0.005, 0.01, 0.05}},
        {61, "longer period", 0.02, false, [](K& k, double a, RandomStream) { k.longer = a; k.jitter = a / 4; return Truths{{"timing.extra_period", a * (1 + 0.25 * 0.79788)}}; }},
        {62, "clock drift", 0.02, true, [](K& k, double a, RandomStream) { k.drift = a; return Truths{{"timing.clock_drift", a}}; }},
        // a grid finer than five times the noise of one arrival leaves no trace in it
        {63, "batches", 0.2, false, [](K& k, double a, RandomStream) { k.batch = a; return Truths{{"timing.batch", a}}; },
            std::array{0.001, 0.0031, 0.017}},
        {0, "limping frame", 0.02, false, [](K& k, double a, RandomStream) { k.limp = a; return Truths{}; }},
        {0, "curved clock", 0.1, false, [](K& k, double a, RandomStream) { k.sag = a; return Truths{}; }},
    });
    // clang-format on
}

}  // namespace puckloop::gap::selftest
