#include "selftest/benches/bench.h"
#include "selftest/benches/benches.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace puckloop::gap::selftest {

namespace {

using Truths = std::vector<Truth>;

constexpr double kTimingNoise = 0.0005;  // s
constexpr double kLoopTick = 0.0001;     // s: when in its loop the robot reads its clock
constexpr double kQuantum = 1e-5;        // s
constexpr int kRuns = 8;
constexpr int kCycles = 200;

WrittenExperiment exact_timing(const TimingKnobs& knobs, std::uint64_t seed, const std::string&) {
    WrittenExperiment experiment;
    experiment.kind = "timing";
    for (int r = 0; r < kRuns; ++r) {
        RandomStream content(seed, fmt::format("content {}", r));
        FrameSource source(knobs, RandomStream(seed, fmt::format("frames {}", r)));
        WrittenRun run;
        for (long n = 0; n < kCycles; ++n) {
            Cycle c{};
            c.number = n;
            c.bytes = 84 + static_cast<double>(content.below(3)) * 20;
            c.edges = static_cast<double>(content.below(20));
            c.i2c = static_cast<double>(content.below(4) * 4);
            c.load = 0.1 * static_cast<double>(content.below(5));
            const Arrived a = source.next(c);
            run.column("seq").values.push_back(static_cast<double>(n));
            run.column("t_robot_s", "s").values.push_back(a.robot);
            run.column("t_host_s", "s").values.push_back(a.host);
            run.column("nominal_period", "ms").values.push_back(100);
            run.column("bytes").values.push_back(c.bytes);
            run.column("edges").values.push_back(c.edges);
            run.column("i2c_reads").values.push_back(c.i2c);
            run.column("load").values.push_back(c.load);
            run.column("frame_ok").values.push_back(a.ok ? 1 : 0);
            run.column("shifted").values.push_back(a.shifted ? 1 : 0);
            run.column("order").values.push_back(r + 1);
        }
        experiment.runs.push_back(std::move(run));
    }
    return experiment;
}

void measure_timing(WrittenExperiment& experiment, const TimingKnobs&, const NoiseStyle& style,
                    std::uint64_t seed) {
    for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
        NoiseSeries noise(style, kTimingNoise, RandomStream(seed, fmt::format("host {}", r)));
        NoiseSeries tick({}, kLoopTick, RandomStream(seed, fmt::format("robot {}", r)));
        double last = -1.0;
        for (double& value : experiment.runs[r].column("t_robot_s").values) {
            value = std::max(quantised(value + tick.next(), kQuantum), last);
            last = value;
        }
        last = -1.0;
        for (double& value : experiment.runs[r].column("t_host_s").values) {
            value =
                std::max(quantised(value + noise.next(), kQuantum), last);  // a host's clock does not go back
            last = value;
        }
    }
}

}  // namespace

const Rig<TimingKnobs>& timing_rig() {
    static const Rig<TimingKnobs> rig{
        "timing",
        {{"t_host_s", kTimingNoise, true},
         {"t_robot_s", kTimingNoise, true},
         {"frame_ok", 1.0},
         {"shifted", 1.0}},
        exact_timing,
        measure_timing,
        [](const TimingKnobs&, std::uint64_t, const std::string&) { return 0.0; }};
    return rig;
}

std::unique_ptr<Bench> timing_bench() {
    constexpr double kMostLost = 0.9;  // of the frames: where none is whole there is no experiment
    // clang-format off
    return std::make_unique<BenchOf<TimingKnobs>>(timing_rig(), std::vector<HiddenEffect<TimingKnobs>>{
        {57, "stretched I2C", 0.002, false, turned(&TimingKnobs::i2c_stretch, "timing.i2c_stretch")},
        {58, "baud mismatch", 0.1, false, [](TimingKnobs& k, double a, RandomStream) { k.baud_error = a; return Truths{{"timing.edge_errors", 4 * (a - 0.02)}}; },
            std::array{0.0205, 0.021, 0.025}},
        {59, "FIFO overrun", kMostLost, false, turned(&TimingKnobs::overrun, "timing.overrun"),
            std::array{0.03, 0.1, 0.4}},
        {60, "cut frames", kMostLost, false, turned(&TimingKnobs::truncated, "timing.truncation"),
            std::array{0.005, 0.01, 0.05}},
        {61, "longer period", 0.02, false, [](TimingKnobs& k, double a, RandomStream) { k.longer = a; k.jitter = a / 4; return Truths{{"timing.extra_period", a * (1 + 0.25 * 0.79788)}}; }},
        {62, "clock drift", 0.02, true, turned(&TimingKnobs::drift, "timing.clock_drift")},
        // a grid finer than five times the noise of one arrival leaves no trace in it
        {63, "batches", 0.2, false, turned(&TimingKnobs::batch, "timing.batch"),
            std::array{0.001, 0.0031, 0.017}},
        {0, "limping frame", 0.02, false, turned(&TimingKnobs::limp)},
        {0, "curved clock", 0.1, false, turned(&TimingKnobs::sag)},
    });
    // clang-format on
}

}  // namespace puckloop::gap::selftest
