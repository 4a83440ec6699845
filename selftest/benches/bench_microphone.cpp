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

constexpr double kMicrophoneNoise = 5.0;  // counts
constexpr double kMicrophoneFullScale = 4095;
constexpr double kMicrophoneRow = 0.1;   // s
constexpr double kMicrophonePause = 20;  // s between runs
constexpr double kAmplitude = 400;       // counts at 0.1 m
constexpr int kMicrophoneRepeats = 3;
constexpr std::array<double, 8> kDistances{0.05, 0.07, 0.1, 0.14, 0.2, 0.28, 0.4, 0.6};
constexpr std::array<double, kMicrophones> kAxes3{-1.05, 1.05, std::numbers::pi};  // rad: right, left, rear

WrittenExperiment exact_microphone(const MicrophoneKnobs& knobs, std::uint64_t seed, const std::string&) {
    RandomStream random(seed, "loudspeaker");
    WrittenExperiment experiment;
    experiment.kind = "microphone";
    experiment.instruments = {{"level", 0, 4095, 1}};
    double clock = 5.0;
    for (int repeat = 0; repeat < kMicrophoneRepeats; ++repeat)
        for (const char* part : {"distances", "turn", "motors", "windows"}) {
            WrittenRun run;
            run.conditions = {{"part", part}};
            const std::string what = part;
            auto distances = kDistances;
            for (std::size_t k = distances.size(); k > 1; --k)
                std::swap(distances[k - 1], distances[random.below(k)]);
            std::vector<Listening> plan;
            for (std::size_t m = 0; m < kMicrophones; ++m)
                for (std::size_t k = 0; k < distances.size(); ++k)
                    for (int again = 0; again < 5; ++again) {
                        Listening l{clock, distances[k], 0.0, kAmplitude, m, 0.0, 100, 0.0};
                        if (what == "turn") {
                            l.distance = 0.1;
                            l.angle =
                                std::remainder(static_cast<double>(k) * std::numbers::pi / 4 - kAxes3[m],
                                               2 * std::numbers::pi);
                        }
                        if (what == "motors") l.motors = 600;
                        if (what == "windows") {
                            l.distance = 0.1;
                            l.window = k % 2 == 0 ? 100 : 50;
                        }
                        plan.push_back(l);
                        clock += kMicrophoneRow;
                    }
            for (std::size_t k = 0; k < plan.size(); ++k) {
                Listening& l = plan[k];
                l.share = static_cast<double>(k) / static_cast<double>(plan.size());
                run.column("t_s", "s").values.push_back(l.t);
                run.column("level", "counts").values.push_back(loudness(knobs, l));
                run.column("distance_m", "m").values.push_back(l.distance);
                run.column("angle_rad", "rad").values.push_back(l.angle);
                run.column("mic").values.push_back(static_cast<double>(l.microphone));
                run.column("amplitude", "counts").values.push_back(l.amplitude);
                run.column("window").values.push_back(l.window);
                run.column("motor_speed", "steps/s").values.push_back(l.motors);
                run.column("order").values.push_back(static_cast<double>(experiment.runs.size() + 1));
            }
            clock += kMicrophonePause;
            experiment.runs.push_back(std::move(run));
        }
    return experiment;
}

void measure_microphone(WrittenExperiment& experiment, const MicrophoneKnobs&, const NoiseStyle& style,
                        std::uint64_t seed) {
    for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
        NoiseSeries noise(style, kMicrophoneNoise, RandomStream(seed, fmt::format("level {}", r)));
        for (double& value : experiment.runs[r].column("level").values)
            value = std::clamp(std::round(value + noise.next()), 0.0, kMicrophoneFullScale);
    }
}

}  // namespace

const Rig<MicrophoneKnobs>& microphone_rig() {
    static const Rig<MicrophoneKnobs> rig{
        "microphone",
        {{"level", kMicrophoneNoise}},
        exact_microphone,
        measure_microphone,
        [](const MicrophoneKnobs&, std::uint64_t, const std::string&) { return 0.0; }};
    return rig;
}

std::unique_ptr<Bench> microphone_bench() {
    // clang-format off
    return std::make_unique<BenchOf<MicrophoneKnobs>>(microphone_rig(), std::vector<HiddenEffect<MicrophoneKnobs>>{
        {41, "gain spread", 0.3, false, [](MicrophoneKnobs& k, double a, RandomStream r) {
            return scattered(k.gain, "microphone.gain", [&] { return std::exp(a * r.normal()); }); }, {}, "", 0, "microphone_gain"},
        {41, "own noise", 40, false, turned(&MicrophoneKnobs::self_noise, "microphone.self_noise"), {}, "", 0, "microphone_self_noise"},
        {41, "fall with distance", 0.4, true, [](MicrophoneKnobs& k, double a, RandomStream) { k.exponent = a; return Truths{{"microphone.exponent", 1 + a}}; }, {}, "", 0, "microphone_fall"},
        {41, "directivity", 0.5, false, turned(&MicrophoneKnobs::directivity, "microphone.directivity"), {}, "", 0, "microphone_directivity"},
        {42, "short window", 0.9, false, turned(&MicrophoneKnobs::short_window, "microphone.window_lost")},
        {33, "warm-up drift", 0.3, true, turned(&MicrophoneKnobs::warm, "microphone.warmup_gain")},
        {0, "room mode", 0.5, false, turned(&MicrophoneKnobs::node)},
        {0, "spells of loss", 0.5, false, turned(&MicrophoneKnobs::burst)},
    });
    // clang-format on
}

}  // namespace puckloop::gap::selftest
