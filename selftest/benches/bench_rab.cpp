#include "selftest/benches/bench.h"
#include "selftest/benches/benches.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace puckloop::gap::selftest {

namespace {

using Truths = std::vector<Truth>;

constexpr double kBearingNoise = 0.07;   // rad
constexpr double kUsualSpread = 0.13;    // of ln strength
constexpr double kUsualStrength = 1000;  // counts
constexpr double kRabFullScale = 4095;
constexpr double kMessageEvery = 0.1;     // s between two messages of the sender
constexpr double kFrame = 0.0092;         // s
constexpr double kBearingQuantum = 1e-4;  // rad
constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr int kRabRepeats = 3;
constexpr const char* kLight = "light";  // what the rail cuts: noise comes before it

class RabPlan {
  public:
    RabPlan(const RabKnobs& knobs, std::uint64_t seed)
        : knobs_(knobs), chance_(seed, "messages"), place_(seed, "bearings"), beat_(seed, "beats") {}

    void begin(const char* part) {
        runs_.emplace_back();
        runs_.back().conditions = {{"part", part}};
        t_ = 0.0;
        beat_begun_ = beat_.uniform() * knobs_.beat_period;
    }
    void send(int messages, double distance, std::size_t receiver, int senders, double rate) {
        WrittenRun& run = runs_.back();
        const double bearing = std::remainder(receiver_direction(receiver) + 0.1 * (2 * place_.uniform() - 1),
                                              2 * std::numbers::pi);
        for (int k = 0; k < messages; ++k, t_ += kMessageEvery) {
            const Sending s{t_,     distance,      bearing, receiver,   senders,
                            kFrame, kMessageEvery, rate,    beat_begun_};
            const Hearing h = hear(knobs_, s, chance_);
            run.column("t_s", "s").values.push_back(t_);
            run.column("distance_m", "cm").values.push_back(distance * 100);
            run.column("true_bearing_rad", "rad").values.push_back(bearing);
            run.column("receiver").values.push_back(static_cast<double>(receiver + 1));
            run.column("senders").values.push_back(senders);
            run.column("frame_time", "ms").values.push_back(kFrame * 1e3);
            run.column("send_period", "ms").values.push_back(kMessageEvery * 1e3);
            run.column("arrival_rate", "Hz").values.push_back(rate);
            run.column("received").values.push_back(h.received ? 1 : 0);
            run.column("strength", "counts").values.push_back(h.received ? h.strength : kNothing);
            run.column("bearing_rad", "rad").values.push_back(h.received ? h.bearing : kNothing);
            run.column(kLight).values.push_back(h.light);
            run.column("order").values.push_back(static_cast<double>(runs_.size()));
        }
    }
    std::vector<WrittenRun> take() { return std::move(runs_); }

  private:
    RabKnobs knobs_;
    RandomStream chance_, place_, beat_;
    std::vector<WrittenRun> runs_;
    double t_ = 0.0, beat_begun_ = 0.0;
};

WrittenExperiment exact_rab(const RabKnobs& knobs, std::uint64_t seed, const std::string& variant) {
    RabPlan plan(knobs, seed);
    for (int repeat = 0; repeat < kRabRepeats; ++repeat) {
        plan.begin("distances");
        for (const double distance : kStrengthDistances)
            plan.send(16, distance, variant == "one pair" ? 0 : static_cast<std::size_t>(repeat * 4), 1, 10);
        if (variant == "one pair") continue;
        plan.begin("turn");
        for (std::size_t receiver = 0; receiver < kReceivers; ++receiver)
            plan.send(12, 0.30, receiver, 1, 10);
        plan.begin("senders");
        for (const int senders : {1, 2, 3, 4})
            plan.send(40, 0.30, 0, senders, 10.0 * senders);
        plan.begin("rates");
        for (const double rate : {10.0, 30.0, 60.0, 120.0})
            plan.send(40, 0.15, 0, 1, rate);
    }
    WrittenExperiment experiment;
    experiment.kind = "rab";
    experiment.instruments = {{"strength", 0, 4095, 1}};
    experiment.runs = plan.take();
    return experiment;
}

void measure_rab(WrittenExperiment& experiment, const RabKnobs& knobs, const NoiseStyle& style,
                 std::uint64_t seed) {
    for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
        WrittenRun& run = experiment.runs[r];
        NoiseSeries strength(style, 1.0, RandomStream(seed, fmt::format("strength {}", r)));
        NoiseSeries bearing(style, kBearingNoise, RandomStream(seed, fmt::format("bearing {}", r)));
        for (std::size_t k = 0; k < run.rows(); ++k) {
            const double sd =
                strength_spread(run.find("distance_m")->values[k] / 100) * (1.0 + knobs.more_spread);
            double& level = run.column("strength").values[k];
            const double light = run.find(kLight)->values[k] * std::exp(sd * strength.next());
            level = std::round(std::min({light, knobs.saturation, kRabFullScale}));
            double& way = run.column("bearing_rad").values[k];
            way = quantised(way + bearing.next(), kBearingQuantum);
            if (run.find("received")->values[k] == 0.0) level = way = kNothing;
        }
        std::erase_if(run.columns, [](const WrittenColumn& column) { return column.name == kLight; });
    }
}

}  // namespace

const Rig<RabKnobs>& rab_rig() {
    static const Rig<RabKnobs> rig{
        "rab",
        {{"strength", kUsualSpread * kUsualStrength}, {"bearing_rad", kBearingNoise}, {"received", 1.0}},
        exact_rab,
        measure_rab,
        [](const RabKnobs& knobs, std::uint64_t, const std::string&) { return knobs.more_spread; }};
    return rig;
}

std::unique_ptr<Bench> rab_bench() {
    // Reported are losses up to 85 and 90 %, polls down to one for each control step of 0.1 s, which leaves
    // 10 of 120 messages a second; where nothing arrived at all there would be no experiment.
    constexpr double kMostLost = 0.9;
    // clang-format off
    return std::make_unique<BenchOf<RabKnobs>>(rab_rig(), std::vector<HiddenEffect<RabKnobs>>{
        {46, "receivers' gain", 0.3, false, [](RabKnobs& k, double a, RandomStream r) {
            return scattered(k.gain, "rab.receiver_gain", [&] { return std::exp(a * r.normal()); }, 1); }},
        {47, "more spread", 2.0, false, turned(&RabKnobs::more_spread, "rab.strength_spread")},
        {48, "far floor", 600, false, [](RabKnobs& k, double a, RandomStream) { k.far_floor = 900 + a; return Truths{{"rab.far_floor", 900 + a}}; }},
        {49, "saturation", 0.7, false, [](RabKnobs& k, double a, RandomStream) {
            k.saturation = 4095 * std::exp(-2 * a);
            return Truths{{"rab.saturation", k.saturation}}; }},
        {51, "other paths", 0.5, false, turned(&RabKnobs::reflected, "rab.multipath"),
            std::array{0.03, 0.08, 0.2}},
        {52, "collisions", 1.0, false, turned(&RabKnobs::collisions, "rab.collisions"),
            std::array{0.2, 0.5, 1.0}},
        {53, "random loss", kMostLost, false, turned(&RabKnobs::loss, "rab.random_loss"),
            std::array{0.02, 0.05, 0.15}},
        {54, "polls too slow", kMostLost, false, [](RabKnobs& k, double a, RandomStream) {
            k.poll_rate = 120 * (1 - a);
            return Truths{{"rab.fetch_time", 1 / k.poll_rate}}; },
            std::array{0.1, 0.3, 0.6}},
        {55, "beat of the clocks", kMostLost, false, [](RabKnobs& k, double a, RandomStream) { k.beat = a; k.beat_period = 6; return Truths{{"rab.beat", a}}; },
            std::array{0.02, 0.06, 0.2}},
        {46, "gain of one pair", 2.0, false, [](RabKnobs& k, double a, RandomStream) { k.gain[0] = 1 + a / 4; return Truths{}; },
            {}, "one pair", 26},
        {0, "sector to the left", 1.0, false, turned(&RabKnobs::sector)},
        {0, "bearings swing", 1.0, true, turned(&RabKnobs::wander)},
        {0, "fading", 1.0, false, turned(&RabKnobs::fading)},
    });
    // clang-format on
}

}  // namespace puckloop::gap::selftest
