#include "gap/selftest/effect_lists.h"

#include <fmt/format.h>

#include <cmath>

namespace puckloop::gap::selftest {

namespace {

using Truths = std::vector<Truth>;
using K = ProximityKnobs;
constexpr std::array<double, kRing> kIdle{52, 47, 60, 55, 49, 63, 58, 45};

}  // namespace

std::unique_ptr<Bench> proximity_bench() {
    // clang-format off
    return std::make_unique<BenchOf<K>>(proximity_rig(), std::vector<HiddenEffect<K>>{
        {18, "gain spread", 0.35, false, [](K& k, double a, RandomStream r) {
            Truths truths;
            for (std::size_t i = 0; i < kRing; ++i) {
                k.gain[i] = std::exp(a * r.normal());
                truths.push_back({fmt::format("proximity.gain{}", i), k.gain[i]});
            }
            return truths; }},
        {19, "offsets", 40, false, [](K& k, double a, RandomStream r) {
            Truths truths;
            for (std::size_t i = 0; i < kRing; ++i) {
                k.offset[i] = a * (2 * r.uniform() - 1);
                truths.push_back({fmt::format("proximity.offset{}", i), kIdle[i] + k.offset[i]});
            }
            return truths; }},
        {20, "exponent", 0.5, true, [](K& k, double a, RandomStream) {
            k.exponent = 2 + a;
            return Truths{{"proximity.exponent", 2 + a}, {"proximity.amplitude", kLawAmplitude * std::pow(29.9, a)}}; }, {}, "power law"},
        {21, "saturation", 1.0, false, [](K& k, double a, RandomStream) {
            k.saturation = 4095 - 2500 * a;
            return Truths{{"proximity.saturation", k.saturation}}; }, {}, "power law"},
        {22, "ambient light", 1.0, false, [](K& k, double a, RandomStream) {
            k.light_gain = 2 * a; k.light_offset = 40 * a; k.light_noise = 5 * a;
            return Truths{{"proximity.ambient_gain", 2 * a * 300 / 4095}, {"proximity.ambient_offset", 40 * a}, {"proximity.ambient_noise", 5 * a}}; }},
        {23, "lamp flicker", 30, false, [](K& k, double a, RandomStream) { k.flicker = a; return Truths{{"proximity.flicker", a}}; }},
        {24, "foreign pulses", 300, false, [](K& k, double a, RandomStream) { k.hits = 0.1; k.hit_counts = a; return Truths{}; }},
        {25, "crosstalk", 0.1, false, [](K& k, double a, RandomStream) {
            k.pair = a; k.neighbours = a / 2;
            return Truths{{"proximity.pair_crosstalk", a}, {"proximity.neighbour_crosstalk", a / 2}}; }},
        {26, "object's reflectivity", 0.6, true, [](K& k, double a, RandomStream) {
            k.surface = 1 + a;
            return Truths{{"object.reflectivity2", 1 + a}}; }},
        {27, "incidence", 1.0, false, [](K& k, double a, RandomStream) {
            k.incidence = 1 + a;
            return Truths{{"proximity.incidence_exponent", 1 + a}}; }},
        {28, "sensors turned", 0.15, false, [](K& k, double a, RandomStream r) {
            Truths truths;
            for (std::size_t i = 0; i < kRing; ++i) {
                k.turned[i] = a * (2 * r.uniform() - 1);
                truths.push_back({fmt::format("proximity.direction{}", i), nominal_direction(i) + k.turned[i]});
            }
            return truths; }},
        {29, "motor noise", 6.0, false, [](K& k, double a, RandomStream) {
            k.motor_noise = a;
            return Truths{{"proximity.motor_noise", a / 0.8}}; }},
        {31, "reference sag", 0.04, false, [](K& k, double a, RandomStream) { k.sag = a; return Truths{{"proximity.motor_sag", a}}; }},
        {32, "sample age", 0.1, false, [](K& k, double a, RandomStream) { k.age = a; return Truths{{"proximity.age", a}}; }},
        {33, "warm-up", 0.3, true, [](K& k, double a, RandomStream) {
            k.warm_gain = a; k.warm_time = 200;
            return Truths{{"proximity.warmup_gain", a}}; }},
        {64, "battery", 0.5, true, [](K& k, double a, RandomStream) { k.per_volt = a; return Truths{{"proximity.battery_gain", a}}; }},
        {66, "slow drift", 0.02, true, [](K& k, double a, RandomStream) { k.per_run = a; return Truths{{"proximity.order_drift", a}}; }},
        {34, "dead zone", 200, false, [](K& k, double a, RandomStream) { k.dead_zone = a; return Truths{{"proximity.threshold", a}}; }},
        {35, "noise with the level", 0.1, false, [](K& k, double a, RandomStream) { k.noise_share = a; return Truths{{"proximity.proportional_noise", a}}; }},
        {18, "gain, one object", 0.35, true, [](K& k, double a, RandomStream) { k.gain[2] = 1 + a; return Truths{}; },
            {}, "one object", 26},
        {0, "ripple with distance", 0.3, false, [](K& k, double a, RandomStream) { k.fringe = a; return Truths{}; }},
        {0, "notch at 30 mm", 0.9, false, [](K& k, double a, RandomStream) { k.notch = a; return Truths{}; }},
        {0, "threefold incidence", 0.5, false, [](K& k, double a, RandomStream) { k.swing = a; return Truths{}; }},
        {0, "loose contact", 0.9, false, [](K& k, double a, RandomStream) { k.step = a; return Truths{}; }},
    });
    // clang-format on
}

}  // namespace puckloop::gap::selftest
