#include "gap/selftest/effect_lists.h"

#include <fmt/format.h>

#include <cmath>

namespace puckloop::gap::selftest {

namespace {
using Truths = std::vector<Truth>;
using K = RabKnobs;
}  // namespace

std::unique_ptr<Bench> rab_bench() {
    // clang-format off
    return std::make_unique<BenchOf<K>>(rab_rig(), std::vector<HiddenEffect<K>>{
        {46, "receivers' gain", 0.3, false, [](K& k, double a, RandomStream r) {
            Truths truths;
            for (std::size_t i = 0; i < kReceivers; ++i) {
                k.gain[i] = std::exp(a * r.normal());
                truths.push_back({fmt::format("rab.receiver_gain{}", i + 1), k.gain[i]});
            }
            return truths; }},
        {47, "more spread", 2.0, false, [](K& k, double a, RandomStream) { k.more_spread = a; return Truths{{"rab.strength_spread", a}}; }},
        {48, "far floor", 600, false, [](K& k, double a, RandomStream) { k.far_floor = 900 + a; return Truths{{"rab.far_floor", 900 + a}}; }},
        {49, "saturation", 0.7, false, [](K& k, double a, RandomStream) {
            k.saturation = 4095 * std::exp(-2 * a);
            return Truths{{"rab.saturation", k.saturation}}; }},
        {51, "other paths", 0.5, false, [](K& k, double a, RandomStream) { k.reflected = a; return Truths{{"rab.multipath", a}}; },
            std::array{0.03, 0.08, 0.2}},
        {52, "collisions", 1.0, false, [](K& k, double a, RandomStream) { k.collisions = a; return Truths{{"rab.collisions", a}}; },
            std::array{0.2, 0.5, 1.0}},
        {53, "random loss", 1.0, false, [](K& k, double a, RandomStream) { k.loss = a; return Truths{{"rab.random_loss", a}}; },
            std::array{0.02, 0.05, 0.15}},
        {54, "polls too slow", 1.0, false, [](K& k, double a, RandomStream) {
            k.poll_rate = 120 * (1 - a);
            return Truths{{"rab.fetch_time", 1 / k.poll_rate}}; },
            std::array{0.1, 0.3, 0.6}},
        {55, "beat of the clocks", 1.0, false, [](K& k, double a, RandomStream) { k.beat = a; k.beat_period = 6; return Truths{{"rab.beat", a}}; },
            std::array{0.02, 0.06, 0.2}},
        {46, "gain of one pair", 2.0, false, [](K& k, double a, RandomStream) { k.gain[0] = 1 + a / 4; return Truths{}; },
            {}, "one pair", 26},
        {0, "sector to the left", 1.0, false, [](K& k, double a, RandomStream) { k.sector = a; return Truths{}; }},
        {0, "bearings swing", 1.0, true, [](K& k, double a, RandomStream) { k.wander = a; return Truths{}; }},
        {0, "fading", 1.0, false, [](K& k, double a, RandomStream) { k.fading = a; return Truths{}; }},
    });
    // clang-format on
}

}  // namespace puckloop::gap::selftest
