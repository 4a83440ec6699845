#include "gap/selftest/design_proximity.h"
#include "gap/selftest/rigs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace puckloop::gap::selftest {

namespace {

constexpr double kNoise = 5.0;  // counts: 4-12 on real robots
constexpr double kFullScale = 4095;
constexpr double kDegrees = 180 / std::numbers::pi;

/// Three batteries in turn, each falling while it is in; the middle one is old.
double volts_of(std::size_t run, std::size_t runs) {
    constexpr std::array<double, 3> kFull{4.12, 3.62, 3.90};
    const std::size_t each = std::max<std::size_t>(1, (runs + 2) / 3);
    return kFull[std::min<std::size_t>(run / each, 2)] - 0.02 * static_cast<double>(run % each);
}

/// Scenes of all runs with their readings, in the order of planned_scenes.
HiddenExperiment exact_proximity(const ProximityKnobs& knobs, std::uint64_t seed,
                                 const std::string& variant) {
    RandomStream random(seed, "scenes");
    RandomStream chance(seed, "hits");
    HiddenExperiment experiment;
    experiment.kind = "proximity";
    const bool law = variant == "power law";
    if (law)
        experiment.nominal = {{"proximity.curve", "1"},
                              {"proximity.amplitude", fmt::format("{:.9g}", kLawAmplitude)},
                              {"proximity.origin", fmt::format("{:.9g}", kLawOrigin)},
                              {"proximity.exponent", "2"},
                              {"proximity.saturation", "4095"}};
    experiment.instrument = {{"reading", "{ floor = 0, ceiling = 4095, quantum = 1 }"}};
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
        HiddenRun run;
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
Scene scene_of(const HiddenRun& run, std::size_t row) {
    Scene s{};
    s.ambient = run.find("ambient")->values[row];
    s.motors = run.find("motor_speed")->values[row];
    return s;
}

void measure_proximity(HiddenExperiment& experiment, const ProximityKnobs& knobs, const NoiseStyle& style,
                       std::uint64_t seed) {
    for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
        HiddenRun& run = experiment.runs[r];
        const auto stream = [&](const char* what) {
            return RandomStream(seed, fmt::format("{} {}", what, r));
        };
        NoiseSeries noise(style, kNoise, stream("reading"));
        NoiseSeries more(style, 1.0, stream("more"));
        NoiseSeries light(style, 2.0, stream("ambient"));
        NoiseSeries pair(style, kNoise, stream("pair"));
        NoiseSeries sides(style, kNoise * std::sqrt(2.0), stream("neighbours"));
        for (std::size_t k = 0; k < run.rows(); ++k) {
            double& reading = run.column("reading").values[k];
            const NoiseGrowth growth = noise_growth(knobs, scene_of(run, k), reading);
            reading += growth.factor * noise.next() + growth.extra * more.next();
            if (reading < knobs.dead_zone) reading = 0.0;
            reading = std::clamp(std::round(reading), 0.0, kFullScale);
            double& ambient = run.column("ambient_reading").values[k];
            ambient = std::clamp(std::round(ambient + light.next()), 0.0, kFullScale);
            double& other = run.column("pair_reading").values[k];
            other = std::clamp(std::round(other + pair.next()), 0.0, kFullScale);
            double& neighbours = run.column("neighbour_reading").values[k];
            neighbours = std::max(0.0, std::round(neighbours + sides.next()));
        }
    }
}

double growth_of(const ProximityKnobs& knobs, std::uint64_t seed, const std::string& variant) {
    const HiddenExperiment experiment = exact_proximity(knobs, seed, variant);
    double sum = 0.0, rows = 0.0;
    for (const HiddenRun& run : experiment.runs)
        for (std::size_t k = 0; k < run.rows(); ++k) {
            const NoiseGrowth g = noise_growth(knobs, scene_of(run, k), run.find("reading")->values[k]);
            const double more = std::hypot(g.factor, g.extra / kNoise) - 1.0;
            sum += more * more;
            rows += 1.0;
        }
    return std::sqrt(sum / rows);
}

}  // namespace

const Rig<ProximityKnobs>& proximity_rig() {
    static const Rig<ProximityKnobs> rig{
        "proximity", {{"reading", kNoise}}, exact_proximity, measure_proximity, growth_of};
    return rig;
}

}  // namespace puckloop::gap::selftest
