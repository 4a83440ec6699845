#include "gap/selftest/effect_lists.h"

#include <fmt/format.h>

#include <cmath>

namespace puckloop::gap::selftest {

namespace {
using Truths = std::vector<Truth>;
using K = AccelerometerKnobs;
}  // namespace

std::unique_ptr<Bench> accelerometer_bench() {
    // clang-format off
    return std::make_unique<BenchOf<K>>(accelerometer_rig(), std::vector<HiddenEffect<K>>{
        {39, "bias", 100, false, [](K& k, double a, RandomStream r) {
            Truths truths;
            for (std::size_t i = 0; i < kAxes; ++i) {
                k.bias[i] = a * (2 * r.uniform() - 1);
                truths.push_back({fmt::format("accelerometer.bias{}", i), k.bias[i]});
            }
            return truths; }, {}, "", 0, "accelerometer_bias"},
        {39, "scale and alignment", 1.0, false, [](K& k, double a, RandomStream r) {
            Truths truths;
            for (std::size_t i = 0; i < kAxes; ++i) {
                k.scale[i] = 1 + 0.06 * a * (2 * r.uniform() - 1);
                truths.push_back({fmt::format("accelerometer.scale{}", i), k.scale[i]});
            }
            k.turned = 0.2 * a;
            truths.push_back({"accelerometer.turn", -k.turned});
            return truths; }, {}, "", 0, "accelerometer_scale"},
        {39, "bias of another session", 200, true, [](K& k, double a, RandomStream) {
            k.session_jump = a;
            Truths truths;
            for (std::size_t i = 0; i < kAxes; ++i) truths.push_back({fmt::format("accelerometer.session_bias2{}", i), a});
            return truths; }, {}, "", 0, "accelerometer_session"},
        {40, "vibration", 200, false, [](K& k, double a, RandomStream) { k.vibration = a; return Truths{{"accelerometer.vibration", a}}; }},
        {31, "reference sag", 0.04, false, [](K& k, double a, RandomStream) { k.sag = a; return Truths{{"accelerometer.motor_sag", a}}; }},
        {33, "warm-up drift", 30, true, [](K& k, double a, RandomStream) { k.warm = a; return Truths{{"accelerometer.warmup", a}}; }},
        {0, "pull in left spins", 60, false, [](K& k, double a, RandomStream) { k.spin_pull = a; return Truths{}; }},
        {0, "hold after a stop", 60, false, [](K& k, double a, RandomStream) { k.hold = a; return Truths{}; }},
    });
    // clang-format on
}

}  // namespace puckloop::gap::selftest
