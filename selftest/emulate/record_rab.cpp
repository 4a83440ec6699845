#include "selftest/emulate/record_rab.h"

#include "physics/description/parameters.h"
#include "reproductions/rab/measure.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace puckloop::gap::emulate {

namespace {

constexpr int kPairs = 24;         // of boards: no two runs have the same
constexpr int kRatePairs = 6;      // at each rate: what two runs show alone is not learnt from the others
constexpr double kFrame = 0.0045;  // s on the air
constexpr double kTurn = 0.024;    // s of the stage between two poses

/// What is done with some pairs of boards.
struct Part {
    const char* name;
    std::vector<double> distances;  // m
    int repeats, brief_repeats;
    double turn;       // s
    bool one_emitter;  // at a time
    int left_out;      // first poses, in which a slow host's queue fills; 0: the stage waits for each message
    int pairs, brief_pairs;
};

const std::vector<Part>& parts() {
    static const std::vector<Part> all{
        {"distances",
         {0.0, 0.02, 0.05, 0.10, 0.15, 0.30, 0.45, 0.60, 0.80},
         3,
         2,
         kTurn,
         false,
         0,
         kPairs,
         2},
        {"single emitters", {0.02, 0.05, 0.10, 0.15, 0.20}, 4, 2, kTurn, true, 0, kPairs, 1},
        {"41 messages a second", {0.15}, 72, 40, kTurn, false, 32, kRatePairs, 1},
        {"25 messages a second", {0.15}, 240, 40, 0.040, false, 200, kRatePairs, 0},
        {"10 messages a second", {0.15}, 72, 40, 0.100, false, 32, kRatePairs, 0},
    };
    return all;
}

}  // namespace

int nearest_receiver(double bearing) {
    const physics::Parameters nominal;
    int best = 0;
    double least = 10.0;
    for (int k = 0; k < physics::kIrSensors; ++k) {
        const double off = std::abs(std::remainder(
            bearing - nominal.ir.receiver_angle[static_cast<std::size_t>(k)], 2 * std::numbers::pi));
        if (off >= least) continue;
        least = off;
        best = k;
    }
    return best + 1;
}

WrittenExperiment record_rab(const RecordOptions& options) {
    constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
    WrittenExperiment experiment;
    experiment.kind = "rab";
    experiment.nominal = {{"rab.ring", 1}};
    const auto pairs_of = [&](const Part& part) { return options.brief ? part.brief_pairs : part.pairs; };
    std::size_t all = 0;
    for (const Part& part : parts())
        all += static_cast<std::size_t>(pairs_of(part));
    for (int pair = 0; pair < kPairs; ++pair)
        for (const Part& part : parts()) {
            if (pair >= pairs_of(part)) continue;
            tools::RabMeasurement what;
            what.firmware = options.robot.rab.empty() ? options.tools.rab : options.robot.rab;
            what.distances = part.distances;
            what.repeats = options.brief ? part.brief_repeats : part.repeats;
            what.turn = part.turn;
            what.one_emitter = part.one_emitter;
            what.poll_period = part.left_out == 0 ? 0.0 : options.robot.rab_poll;
            what.parameters = options.robot.parameters;
            what.pairs = 1;
            what.seed = options.seed * 1000 + experiment.runs.size();
            const auto measured = tools::measure_rab(
                what, [](double) {}, nullptr);
            WrittenRun run;
            run.conditions = {{"part", part.name}};
            const bool waited = part.left_out == 0;  // then no rate can be too high
            const auto order = static_cast<double>(experiment.runs.size() + 1);
            double turn = 0;
            for (const tools::RabReadingRow& row : measured.rows) {
                const double time = part.turn / 2 * turn++;
                if (turn <= 2 * part.left_out) continue;
                run.column("t_s", "s").values.push_back(time);
                run.column("distance_m", "cm").values.push_back(what.distances[row.distance] * 100);
                run.column("true_bearing_rad", "rad").values.push_back(row.bearing_true);
                run.column("sender_bearing_rad", "rad").values.push_back(row.bearing_back);
                run.column("emitter").values.push_back(row.emitter);
                run.column("receiver").values.push_back(nearest_receiver(row.bearing_true));
                run.column("senders").values.push_back(1);
                run.column("frame_time", "ms").values.push_back(kFrame * 1e3);
                run.column("send_period", "ms").values.push_back(part.turn * 1e3);
                run.column("arrival_rate", "Hz").values.push_back(waited ? 0.0 : 1 / part.turn);
                run.column("received").values.push_back(row.received ? 1 : 0);
                run.column("strength", "counts").values.push_back(row.received ? row.range : kNothing);
                run.column("bearing_rad", "rad").values.push_back(row.received ? row.bearing : kNothing);
                run.column("order").values.push_back(order);
            }
            experiment.runs.push_back(std::move(run));
            if (options.done) options.done(experiment.runs.size(), all);
        }
    return experiment;
}

}  // namespace puckloop::gap::emulate
