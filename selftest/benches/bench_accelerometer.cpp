#include "selftest/benches/bench.h"
#include "selftest/benches/benches.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace puckloop::gap::selftest {

namespace {

using Truths = std::vector<Truth>;

constexpr double kAccelerometerRow = 0.1;    // s
constexpr double kAccelerometerNoise = 6.0;  // counts
constexpr double kAccelerometerFullScale = 4095;
constexpr double kAccelerometerPause = 30;  // s between runs
constexpr double kTiltDegree = std::numbers::pi / 180;
constexpr const char* kAxisNames[] = {"ax", "ay", "az"};
constexpr int kRowsOfARun = 80;

enum class Doing { Tilts, Steady, StopAndGo, Spin };

Attitude attitude(Doing doing, int k, double t, int session, RandomStream& random) {
    Attitude a{};
    a.t = t;
    a.session = session;
    a.since_stop = 1e3;
    if (doing == Doing::Tilts) {
        constexpr std::array<std::pair<double, double>, 6> tilts{
            {{0, 0}, {10, 0}, {-10, 0}, {0, 10}, {0, -10}, {6, -6}}};
        const auto& tilt = tilts[static_cast<std::size_t>(k / 13) % tilts.size()];
        a.pitch = tilt.first * kTiltDegree;
        a.roll = tilt.second * kTiltDegree;
    } else if (doing == Doing::Steady) {
        constexpr std::array<double, 4> speeds{200, 500, 800, 1000};
        a.steps = speeds[static_cast<std::size_t>(k / 20) % speeds.size()];
    } else if (doing == Doing::StopAndGo) {
        const int phase = k % 20;
        a.steps = phase < 10 ? 600 : 0;
        a.forward = phase == 0 ? 0.77 : phase == 10 ? -0.77 : 0.0;
        a.since_stop = phase >= 10 ? (phase - 10) * kAccelerometerRow : 1e3;
    } else {
        a.steps = 300 + 300 * std::floor(3 * random.uniform()) / 2;
        a.turning = (k / 20) % 2 == 0 ? 2 * a.steps : -2 * a.steps;
    }
    return a;
}

WrittenExperiment exact_accelerometer(const AccelerometerKnobs& knobs, std::uint64_t seed,
                                      const std::string&) {
    RandomStream random(seed, "attitudes");
    WrittenExperiment experiment;
    experiment.kind = "accelerometer";
    for (const char* axis : kAxisNames)
        experiment.instruments.push_back({axis, 0, 4095, 1});
    double t = 5.0;
    for (int session = 1; session <= 2; ++session) {
        t = 5.0;
        for (int repeat = 0; repeat < 2; ++repeat)
            for (const Doing doing : {Doing::Tilts, Doing::Steady, Doing::StopAndGo, Doing::Spin}) {
                WrittenRun run;
                for (int k = 0; k < kRowsOfARun; ++k, t += kAccelerometerRow) {
                    const Attitude a = attitude(doing, k, t, session, random);
                    const auto counts = feel(knobs, a);
                    run.column("t_s", "s").values.push_back(a.t);
                    for (std::size_t i = 0; i < kAxes; ++i)
                        run.column(kAxisNames[i], "counts").values.push_back(counts[i]);
                    run.column("pitch_rad", "deg").values.push_back(a.pitch / kTiltDegree);
                    run.column("roll_rad", "deg").values.push_back(a.roll / kTiltDegree);
                    run.column("acceleration", "m/s2").values.push_back(a.forward);
                    run.column("lateral", "m/s2").values.push_back(a.left);
                    run.column("motor_speed", "steps/s").values.push_back(a.steps);
                    run.column("session").values.push_back(session);
                    run.column("order").values.push_back(static_cast<double>(experiment.runs.size() + 1));
                }
                t += kAccelerometerPause;
                experiment.runs.push_back(std::move(run));
            }
    }
    return experiment;
}

double shaking(const AccelerometerKnobs& knobs, double steps) {
    return knobs.vibration * steps / 1000;
}

void measure_accelerometer(WrittenExperiment& experiment, const AccelerometerKnobs& knobs,
                           const NoiseStyle& style, std::uint64_t seed) {
    for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
        WrittenRun& run = experiment.runs[r];
        for (const char* axis : kAxisNames) {
            NoiseSeries noise(style, kAccelerometerNoise, RandomStream(seed, fmt::format("{} {}", axis, r)));
            NoiseSeries shake(style, 1.0, RandomStream(seed, fmt::format("shake {} {}", axis, r)));
            for (std::size_t k = 0; k < run.rows(); ++k) {
                double& value = run.column(axis).values[k];
                value += noise.next() + shaking(knobs, run.find("motor_speed")->values[k]) * shake.next();
                value = std::clamp(std::round(value), 0.0, kAccelerometerFullScale);
            }
        }
    }
}

double growth_of_accelerometer(const AccelerometerKnobs& knobs, std::uint64_t seed,
                               const std::string& variant) {
    double sum = 0.0, rows = 0.0;
    for (const WrittenRun& run : exact_accelerometer(knobs, seed, variant).runs)
        for (const double steps : run.find("motor_speed")->values) {
            const double more = std::hypot(1.0, shaking(knobs, steps) / kAccelerometerNoise) - 1.0;
            sum += more * more;
            rows += 1.0;
        }
    return std::sqrt(sum / rows);
}

}  // namespace

const Rig<AccelerometerKnobs>& accelerometer_rig() {
    static const Rig<AccelerometerKnobs> rig{
        "accelerometer",
        {{"ax", kAccelerometerNoise}, {"ay", kAccelerometerNoise}, {"az", kAccelerometerNoise}},
        exact_accelerometer,
        measure_accelerometer,
        growth_of_accelerometer};
    return rig;
}

std::unique_ptr<Bench> accelerometer_bench() {
    // clang-format off
    return std::make_unique<BenchOf<AccelerometerKnobs>>(accelerometer_rig(), std::vector<HiddenEffect<AccelerometerKnobs>>{
        {39, "bias", 100, false, [](AccelerometerKnobs& k, double a, RandomStream r) {
            return scattered(k.bias, "accelerometer.bias", [&] { return a * (2 * r.uniform() - 1); }); }, {}, "", 0, "accelerometer_bias"},
        {39, "scale and alignment", 1.0, false, [](AccelerometerKnobs& k, double a, RandomStream r) {
            Truths truths;
            for (std::size_t i = 0; i < kAxes; ++i) {
                k.scale[i] = 1 + 0.06 * a * (2 * r.uniform() - 1);
                truths.push_back({fmt::format("accelerometer.scale{}", i), k.scale[i]});
            }
            k.turned = 0.2 * a;
            truths.push_back({"accelerometer.turn", -k.turned});
            return truths; }, {}, "", 0, "accelerometer_scale"},
        {39, "bias of another session", 200, true, [](AccelerometerKnobs& k, double a, RandomStream) {
            k.session_jump = a;
            Truths truths;
            for (std::size_t i = 0; i < kAxes; ++i) truths.push_back({fmt::format("accelerometer.session_bias2{}", i), a});
            return truths; }, {}, "", 0, "accelerometer_session"},
        {40, "vibration", 200, false, turned(&AccelerometerKnobs::vibration, "accelerometer.vibration")},
        {31, "reference sag", 0.04, false, turned(&AccelerometerKnobs::sag, "accelerometer.motor_sag")},
        {33, "warm-up drift", 30, true, turned(&AccelerometerKnobs::warm, "accelerometer.warmup")},
        {0, "pull in left spins", 60, false, turned(&AccelerometerKnobs::spin_pull)},
        {0, "hold after a stop", 60, false, turned(&AccelerometerKnobs::hold)},
    });
    // clang-format on
}

}  // namespace puckloop::gap::selftest
