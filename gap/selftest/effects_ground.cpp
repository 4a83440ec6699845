#include "gap/selftest/effect_lists.h"

#include <fmt/format.h>

#include <cmath>

namespace puckloop::gap::selftest {

namespace {
using Truths = std::vector<Truth>;
using K = GroundKnobs;
}  // namespace

std::unique_ptr<Bench> ground_bench() {
    // clang-format off
    return std::make_unique<BenchOf<K>>(ground_rig(), std::vector<HiddenEffect<K>>{
        {36, "gain and offset", 1.0, false, [](K& k, double a, RandomStream r) {
            Truths truths;
            for (std::size_t i = 0; i < kGroundRow; ++i) {
                k.gain[i] = 1 - 0.2 * a * r.uniform();
                k.offset[i] = 60 * a * (2 * r.uniform() - 1);
                truths.push_back({fmt::format("ground.gain{}", i), k.gain[i]});
                truths.push_back({fmt::format("ground.offset{}", i), k.offset[i]});
            }
            return truths; }},
        {37, "pitch while starting", 0.3, false, [](K& k, double a, RandomStream) { k.pitch = a; return Truths{{"ground.acceleration_tilt", a / (43.75 * 0.030)}}; }},
        {38, "further ahead", 0.01, true, [](K& k, double a, RandomStream) { k.forward = a; return Truths{{"ground.forward_error", a}}; }, {}, "", 0, "ground_position"},
        {38, "lag", 0.3, false, [](K& k, double a, RandomStream) { k.lag = a; return Truths{{"ground.lag", a}}; }, {}, "", 0, "ground_lag"},
        {0, "weave of the floor", 60, false, [](K& k, double a, RandomStream) { k.weave = a; return Truths{}; }},
        {0, "memory of the dark", 0.3, false, [](K& k, double a, RandomStream) { k.hysteresis = a; return Truths{}; }},
        {0, "glare to the north", 60, false, [](K& k, double a, RandomStream) { k.glare = -a; return Truths{}; }},
    });
    // clang-format on
}

}  // namespace puckloop::gap::selftest
