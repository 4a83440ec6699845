#include "selftest/benches/bench.h"
#include "selftest/benches/benches.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::gap::selftest {

namespace {

using Truths = std::vector<Truth>;

constexpr double kGroundRowTime = 0.1;    // s
constexpr double kGroundNoise = 3.0;      // counts
constexpr double kGroundFullScale = 967;  // where the sensors saturate
constexpr double kSlope = 1e-4;           // m over which a change of grey is taken
constexpr int kRunsOfAKind = 3;

/// Drives over the printed floor: to and fro along the stripes' normal, a slanting line, stop and go.
std::vector<Stand> path(RandomStream& random, int shape, int repeat) {
    std::vector<Stand> stands;
    double x = 0.4 * random.uniform(), y = -0.2 + 0.3 * random.uniform();
    const double third = 2 * std::numbers::pi / kRunsOfAKind;
    const double heading = shape == 0   ? 0.0
                           : shape == 1 ? std::numbers::pi
                                        : third * (repeat + 0.2 + 0.2 * random.uniform());
    double speed = 0.0;
    for (int k = 0; k < 50; ++k) {
        const double t = k * kGroundRowTime;
        const double wanted = shape == 3 ? ((k / 6) % 2 == 0 ? 0.10 : 0.0) : 0.04 + 0.04 * shape;
        const double acceleration = std::clamp((wanted - speed) / kGroundRowTime, -1.0, 1.0);
        stands.push_back({t, x, y, heading, speed, acceleration});
        const double way = (speed + acceleration * kGroundRowTime / 2) * kGroundRowTime;
        speed += acceleration * kGroundRowTime;
        x += way * std::cos(heading);
        y += way * std::sin(heading);
    }
    return stands;
}

WrittenExperiment exact_ground(const GroundKnobs& knobs, std::uint64_t seed, const std::string&) {
    RandomStream random(seed, "paths");
    WrittenExperiment experiment;
    experiment.kind = "ground";
    experiment.instruments = {{"reading", 0, 967, 1}};
    for (int repeat = 0; repeat < kRunsOfAKind; ++repeat)
        for (int shape = 0; shape < 4; ++shape) {
            const auto stands = path(random, shape, repeat);
            const auto readings = look_down(knobs, stands);
            WrittenRun run;
            run.conditions = {{"drive", shape == 3 ? "stop and go" : "steady"},
                              {"course", std::sin(stands.front().heading) > 0.5 ? "north" : "other"}};
            for (std::size_t i = 0; i < kGroundRow; ++i)
                for (std::size_t k = 0; k < stands.size(); ++k) {
                    const Stand& s = stands[k];
                    const auto grey = [&](double ahead, double aside) {
                        return nominal_grey(s, i, ahead, aside);
                    };
                    run.column("t_s", "s").values.push_back(s.t + 10.0 * static_cast<double>(i));
                    run.column("sensor").values.push_back(static_cast<double>(i));
                    run.column("reading", "counts").values.push_back(readings[k][i]);
                    run.column("grey").values.push_back(grey(0, 0));
                    run.column("grey_rate", "1/m")
                        .values.push_back((grey(kSlope, 0) - grey(-kSlope, 0)) / (2 * kSlope));
                    run.column("grey_across", "1/m")
                        .values.push_back((grey(0, kSlope) - grey(0, -kSlope)) / (2 * kSlope));
                    run.column("speed", "m/s").values.push_back(s.speed);
                    run.column("acceleration", "m/s2").values.push_back(s.acceleration);
                    run.column("pitch_rad").unit = "rad";
                    run.column("pitch_rad").values.push_back(0.0);
                    run.column("order").values.push_back(static_cast<double>(experiment.runs.size() + 1));
                }
            experiment.runs.push_back(std::move(run));
        }
    return experiment;
}

void measure_ground(WrittenExperiment& experiment, const GroundKnobs&, const NoiseStyle& style,
                    std::uint64_t seed) {
    for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
        NoiseSeries noise(style, kGroundNoise, RandomStream(seed, fmt::format("reading {}", r)));
        for (double& value : experiment.runs[r].column("reading").values)
            value = std::clamp(std::round(value + noise.next()), 0.0, kGroundFullScale);
    }
}

}  // namespace

const Rig<GroundKnobs>& ground_rig() {
    static const Rig<GroundKnobs> rig{
        "ground",
        {{"reading", kGroundNoise}},
        exact_ground,
        measure_ground,
        [](const GroundKnobs&, std::uint64_t, const std::string&) { return 0.0; }};
    return rig;
}

std::unique_ptr<Bench> ground_bench() {
    // clang-format off
    return std::make_unique<BenchOf<GroundKnobs>>(ground_rig(), std::vector<HiddenEffect<GroundKnobs>>{
        {36, "gain and offset", 1.0, false, [](GroundKnobs& k, double a, RandomStream r) {
            Truths truths;
            for (std::size_t i = 0; i < kGroundRow; ++i) {
                k.gain[i] = 1 - 0.2 * a * r.uniform();
                k.offset[i] = 60 * a * (2 * r.uniform() - 1);
                truths.push_back({fmt::format("ground.gain{}", i), k.gain[i]});
                truths.push_back({fmt::format("ground.offset{}", i), k.offset[i]});
            }
            return truths; }},
        {37, "pitch while starting", 0.3, false, [](GroundKnobs& k, double a, RandomStream) { k.pitch = a; return Truths{{"ground.acceleration_tilt", a / (43.75 * 0.030)}}; }},
        {38, "further ahead", 0.01, true, turned(&GroundKnobs::forward, "ground.forward_error"), {}, "", 0, "ground_position"},
        {38, "lag", 0.3, false, turned(&GroundKnobs::lag, "ground.lag"), {}, "", 0, "ground_lag"},
        {0, "weave of the floor", 60, false, turned(&GroundKnobs::weave)},
        {0, "memory of the dark", 0.3, false, turned(&GroundKnobs::hysteresis)},
        {0, "glare to the north", 60, false, [](GroundKnobs& k, double a, RandomStream) { k.glare = -a; return Truths{}; }},
    });
    // clang-format on
}

}  // namespace puckloop::gap::selftest
