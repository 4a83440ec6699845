#include "selftest/benches/bench.h"
#include "selftest/benches/benches.h"
#include "selftest/benches/design_proximity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace puckloop::gap::selftest {

namespace {

using Truths = std::vector<Truth>;
constexpr std::array<double, kRing> kIdle{52, 47, 60, 55, 49, 63, 58, 45};

constexpr double kProximityNoise = 5.0;  // counts: 4-12 on real robots
constexpr double kProximityFullScale = 4095;
constexpr double kDegrees = 180 / std::numbers::pi;

/// Three batteries in turn, each falling while it is in; the middle one is old.
double volts_of(std::size_t run, std::size_t runs) {
    constexpr std::array<double, 3> kFull{4.12, 3.62, 3.90};
    const std::size_t each = std::max<std::size_t>(1, (runs + 2) / 3);
    return kFull[std::min<std::size_t>(run / each, 2)] - 0.02 * static_cast<double>(run % each);
}

/// Scenes of all runs with their readings, in the order of planned_scenes.
WrittenExperiment exact_proximity(const ProximityKnobs& knobs, std::uint64_t seed,
                                  const std::string& variant) {
    RandomStream random(seed, "scenes");
    RandomStream chance(seed, "hits");
    WrittenExperiment experiment;
    experiment.kind = "proximity";
    const bool law = variant == "power law";
    if (law)
        experiment.nominal = {{"proximity.curve", 1},
                              {"proximity.amplitude", kLawAmplitude},
                              {"proximity.origin", kLawOrigin},
                              {"proximity.exponent", 2},
                              {"proximity.saturation", 4095}};
    experiment.instruments = {{"reading", 0, 4095, 1}};
    const auto plans = planned_scenes(random, variant == "one object");
    const double middle = (static_cast<double>(plans.size()) + 1) / 2;
    double mean_volts = 0.0, rows = 0.0;
    for (std::size_t k = 0; k < plans.size(); ++k) {
        const double n = static_cast<double>(plans[k].scenes.size());
        mean_volts += n * volts_of(k, plans.size());
        rows += n;
    }
    mean_volts /= rows;
    int order = 0;
    for (const PlannedScenes& plan : plans) {
        const double volts = volts_of(static_cast<std::size_t>(order), plans.size());
        ++order;
        WrittenRun run;
        run.conditions = plan.conditions;
        for (Scene s : plan.scenes) {
            s.volts = volts - mean_volts;
            s.order = order - middle;
            const RingReading reading = see(knobs, s, law, chance);
            const std::size_t i = s.sensor;
            run.column("t_s", "s").values.push_back(s.t);
            run.column("sensor").values.push_back(static_cast<double>(i));
            run.column("distance_m", "mm").values.push_back(s.gap * 1e3);
            run.column("angle_rad", "deg").values.push_back(-s.incidence * kDegrees);
            run.column("reflectivity").values.push_back(s.reflectivity);
            run.column("object").values.push_back(s.reflectivity < 1.0 ? 2 : 1);
            run.column("velocity", "m/s").values.push_back(-s.closing);
            run.column("ambient").values.push_back(s.ambient);
            run.column("motor_speed", "steps/s").values.push_back(s.motors);
            run.column("reading", "counts").values.push_back(reading.proximity[i]);
            run.column("ambient_reading", "counts").values.push_back(reading.ambient[i]);
            run.column("pair_reading", "counts")
                .values.push_back(std::round(reading.proximity[(i + 4) % kRing]));
            run.column("neighbour_reading", "counts")
                .values.push_back(
                    std::round(reading.proximity[(i + 1) % kRing] + reading.proximity[(i + 7) % kRing]));
            run.column("battery_v", "V").values.push_back(volts);
            run.column("order").values.push_back(order);
        }
        experiment.runs.push_back(std::move(run));
    }
    return experiment;
}

/// What `see` was asked for one row of the table, as far as noise depends on it.
Scene scene_of(const WrittenRun& run, std::size_t row) {
    Scene s{};
    s.ambient = run.find("ambient")->values[row];
    s.motors = run.find("motor_speed")->values[row];
    return s;
}

void measure_proximity(WrittenExperiment& experiment, const ProximityKnobs& knobs, const NoiseStyle& style,
                       std::uint64_t seed) {
    for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
        WrittenRun& run = experiment.runs[r];
        const auto stream = [&](const char* what) {
            return RandomStream(seed, fmt::format("{} {}", what, r));
        };
        NoiseSeries noise(style, kProximityNoise, stream("reading"));
        NoiseSeries more(style, 1.0, stream("more"));
        NoiseSeries light(style, 2.0, stream("ambient"));
        NoiseSeries pair(style, kProximityNoise, stream("pair"));
        NoiseSeries sides(style, kProximityNoise * std::sqrt(2.0), stream("neighbours"));
        for (std::size_t k = 0; k < run.rows(); ++k) {
            double& reading = run.column("reading").values[k];
            const NoiseGrowth growth = noise_growth(knobs, scene_of(run, k), reading);
            reading += growth.factor * noise.next() + growth.extra * more.next();
            if (reading < knobs.dead_zone) reading = 0.0;
            reading = std::clamp(std::round(reading), 0.0, kProximityFullScale);
            double& ambient = run.column("ambient_reading").values[k];
            ambient = std::clamp(std::round(ambient + light.next()), 0.0, kProximityFullScale);
            double& other = run.column("pair_reading").values[k];
            other = std::clamp(std::round(other + pair.next()), 0.0, kProximityFullScale);
            double& neighbours = run.column("neighbour_reading").values[k];
            neighbours = std::max(0.0, std::round(neighbours + sides.next()));
        }
    }
}

double growth_of(const ProximityKnobs& knobs, std::uint64_t seed, const std::string& variant) {
    const WrittenExperiment experiment = exact_proximity(knobs, seed, variant);
    double sum = 0.0, rows = 0.0;
    for (const WrittenRun& run : experiment.runs)
        for (std::size_t k = 0; k < run.rows(); ++k) {
            const NoiseGrowth g = noise_growth(knobs, scene_of(run, k), run.find("reading")->values[k]);
            const double more = std::hypot(g.factor, g.extra / kProximityNoise) - 1.0;
            sum += more * more;
            rows += 1.0;
        }
    return std::sqrt(sum / rows);
}

}  // namespace

const Rig<ProximityKnobs>& proximity_rig() {
    static const Rig<ProximityKnobs> rig{
        "proximity", {{"reading", kProximityNoise}}, exact_proximity, measure_proximity, growth_of};
    return rig;
}

std::unique_ptr<Bench> proximity_bench() {
    // clang-format off
    return std::make_unique<BenchOf<ProximityKnobs>>(proximity_rig(), std::vector<HiddenEffect<ProximityKnobs>>{
        {18, "gain spread", 0.35, false, [](ProximityKnobs& k, double a, RandomStream r) {
            return scattered(k.gain, "proximity.gain", [&] { return std::exp(a * r.normal()); }); }},
        {19, "offsets", 40, false, [](ProximityKnobs& k, double a, RandomStream r) {
            return scattered(k.offset, "proximity.offset", [&] { return a * (2 * r.uniform() - 1); }, 0, [](std::size_t i) { return kIdle[i]; }); }},
        {20, "exponent", 0.5, true, [](ProximityKnobs& k, double a, RandomStream) {
            k.exponent = 2 + a;
            return Truths{{"proximity.exponent", 2 + a}, {"proximity.amplitude", kLawAmplitude * std::pow(29.9, a)}}; }, {}, "power law"},
        {21, "saturation", 1.0, false, [](ProximityKnobs& k, double a, RandomStream) {
            k.saturation = 4095 - 2500 * a;
            return Truths{{"proximity.saturation", k.saturation}}; }, {}, "power law"},
        {22, "ambient light", 1.0, false, [](ProximityKnobs& k, double a, RandomStream) {
            k.light_gain = 2 * a; k.light_offset = 40 * a; k.light_noise = 5 * a;
            return Truths{{"proximity.ambient_gain", 2 * a * 300 / 4095}, {"proximity.ambient_offset", 40 * a}, {"proximity.ambient_noise", 5 * a}}; }},
        {23, "lamp flicker", 30, false, turned(&ProximityKnobs::flicker, "proximity.flicker")},
        {24, "foreign pulses", 300, false, [](ProximityKnobs& k, double a, RandomStream) { k.hits = 0.1; k.hit_counts = a; return Truths{}; }},
        {25, "crosstalk", 0.1, false, [](ProximityKnobs& k, double a, RandomStream) {
            k.pair = a; k.neighbours = a / 2;
            return Truths{{"proximity.pair_crosstalk", a}, {"proximity.neighbour_crosstalk", a / 2}}; }},
        {26, "object's reflectivity", 0.6, true, [](ProximityKnobs& k, double a, RandomStream) {
            k.surface = 1 + a;
            return Truths{{"object.reflectivity2", 1 + a}}; }},
        {27, "incidence", 1.0, false, [](ProximityKnobs& k, double a, RandomStream) {
            k.incidence = 1 + a;
            return Truths{{"proximity.incidence_exponent", 1 + a}}; }},
        {28, "sensors turned", 0.15, false, [](ProximityKnobs& k, double a, RandomStream r) {
            return scattered(k.turned, "proximity.direction", [&] { return a * (2 * r.uniform() - 1); }, 0, [](std::size_t i) { return nominal_direction(i); }); }},
        {29, "motor noise", 6.0, false, [](ProximityKnobs& k, double a, RandomStream) {
            k.motor_noise = a;
            return Truths{{"proximity.motor_noise", a / 0.8}}; }},
        {31, "reference sag", 0.04, false, turned(&ProximityKnobs::sag, "proximity.motor_sag")},
        {32, "sample age", 0.1, false, turned(&ProximityKnobs::age, "proximity.age")},
        {33, "warm-up", 0.3, true, [](ProximityKnobs& k, double a, RandomStream) {
            k.warm_gain = a; k.warm_time = 200;
            return Truths{{"proximity.warmup_gain", a}}; }},
        {64, "battery", 0.5, true, turned(&ProximityKnobs::per_volt, "proximity.battery_gain")},
        {66, "slow drift", 0.02, true, turned(&ProximityKnobs::per_run, "proximity.order_drift")},
        {34, "dead zone", 200, false, turned(&ProximityKnobs::dead_zone, "proximity.threshold")},
        {35, "noise with the level", 0.1, false, turned(&ProximityKnobs::noise_share, "proximity.proportional_noise")},
        {18, "gain, one object", 0.35, true, [](ProximityKnobs& k, double a, RandomStream) { k.gain[2] = 1 + a; return Truths{}; },
            {}, "one object", 26},
        {0, "ripple with distance", 0.3, false, turned(&ProximityKnobs::fringe)},
        {0, "notch at 30 mm", 0.9, false, turned(&ProximityKnobs::notch)},
        {0, "threefold incidence", 0.5, false, turned(&ProximityKnobs::swing)},
        {0, "loose contact", 0.9, false, turned(&ProximityKnobs::step)},
    });
    // clang-format on
}

}  // namespace puckloop::gap::selftest
