#include "gap/selftest/effect_lists.h"

#include <fmt/format.h>

#include <cmath>

namespace puckloop::gap::selftest {

namespace {
using Truths = std::vector<Truth>;
using K = MicrophoneKnobs;
}  // namespace

std::unique_ptr<Bench> microphone_bench() {
    // clang-format off
    return std::make_unique<BenchOf<K>>(microphone_rig(), std::vector<HiddenEffect<K>>{
        {41, "gain spread", 0.3, false, [](K& k, double a, RandomStream r) {
            Truths truths;
            for (std::size_t i = 0; i < kMicrophones; ++i) {
                k.gain[i] = std::exp(a * r.normal());
                truths.push_back({fmt::format("microphone.gain{}", i), k.gain[i]});
            }
            return truths; }, {}, "", 0, "microphone_gain"},
        {41, "own noise", 40, false, [](K& k, double a, RandomStream) { k.self_noise = a; return Truths{{"microphone.self_noise", a}}; }, {}, "", 0, "microphone_self_noise"},
        {41, "fall with distance", 0.4, true, [](K& k, double a, RandomStream) { k.exponent = a; return Truths{{"microphone.exponent", 1 + a}}; }, {}, "", 0, "microphone_fall"},
        {41, "directivity", 0.5, false, [](K& k, double a, RandomStream) { k.directivity = a; return Truths{{"microphone.directivity", a}}; }, {}, "", 0, "microphone_directivity"},
        {42, "short window", 0.9, false, [](K& k, double a, RandomStream) { k.short_window = a; return Truths{{"microphone.window_lost", a}}; }},
        {33, "warm-up drift", 0.3, true, [](K& k, double a, RandomStream) { k.warm = a; return Truths{{"microphone.warmup_gain", a}}; }},
        {0, "room mode", 0.5, false, [](K& k, double a, RandomStream) { k.node = a; return Truths{}; }},
        {0, "spells of loss", 0.5, false, [](K& k, double a, RandomStream) { k.burst = a; return Truths{}; }},
    });
    // clang-format on
}

}  // namespace puckloop::gap::selftest
