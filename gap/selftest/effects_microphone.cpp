#include "gap/selftest/effect_lists.h"

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
            for (double& gain : k.gain) gain = std::exp(a * r.normal());
            return Truths{}; }},
        {41, "own noise", 40, false, [](K& k, double a, RandomStream) { k.self_noise = a; return Truths{}; }},
        {41, "fall with distance", 0.4, true, [](K& k, double a, RandomStream) { k.exponent = a; return Truths{}; }},
        {41, "directivity", 0.5, false, [](K& k, double a, RandomStream) { k.directivity = a; return Truths{}; }},
        {42, "short window", 0.9, false, [](K& k, double a, RandomStream) { k.short_window = a; return Truths{}; }},
        {33, "warm-up drift", 0.1, true, [](K& k, double a, RandomStream) { k.warm = a; return Truths{}; }},
        {0, "room mode", 0.5, false, [](K& k, double a, RandomStream) { k.node = a; return Truths{}; }},
        {0, "late loss", 0.5, false, [](K& k, double a, RandomStream) { k.burst = a; return Truths{}; }},
    });
    // clang-format on
}

}  // namespace puckloop::gap::selftest
