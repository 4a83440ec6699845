#include "gap/emulate/record_rab.h"

#include "physics/parameters.h"
#include "tools/rab/measure.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace puckloop::gap::emulate {

namespace {

constexpr std::array<double, 9> kDistances{0.0, 0.02, 0.05, 0.10, 0.15, 0.30, 0.45, 0.60, 0.80};  // m
constexpr int kPairs = 12, kRepeats = 6;
constexpr int kBriefPairs = 3, kBriefRepeats = 3;
constexpr double kTurn = 0.024;        // s of the stage between two poses
constexpr double kFrame = 0.0045;      // s on the air
constexpr double kSendPeriod = 0.024;  // s of each board

/// Hardware number of the receiver nearest to a direction, by the drawing.
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

}  // namespace

selftest::HiddenExperiment record_rab(const RecordOptions& options) {
    constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
    tools::RabMeasurement what;
    what.firmware = options.robot.rab.empty() ? options.tools.rab : options.robot.rab;
    what.distances.assign(kDistances.begin(), kDistances.end());
    what.repeats = options.brief ? kBriefRepeats : kRepeats;
    what.parameters = options.robot.parameters;
    what.pairs = 1;
    selftest::HiddenExperiment experiment;
    experiment.kind = "rab";
    const int pairs = options.brief ? kBriefPairs : kPairs;
    for (int pair = 0; pair < pairs; ++pair) {
        what.seed = options.seed * 1000 + static_cast<std::uint64_t>(pair);
        const auto measured = tools::measure_rab(
            what, [](double) {}, nullptr);
        selftest::HiddenRun run;
        run.conditions = {{"pair", fmt::format("{}", pair + 1)}};
        double turn = 0;
        for (const tools::RabReadingRow& row : measured.rows) {
            const bool heard = row.received && !row.late;
            run.column("t_s", "s").values.push_back(kTurn / 2 * turn++);
            run.column("distance_m", "cm").values.push_back(what.distances[row.distance] * 100);
            run.column("true_bearing_rad", "rad").values.push_back(row.bearing_true);
            run.column("receiver").values.push_back(nearest_receiver(row.bearing_true));
            run.column("senders").values.push_back(1);
            run.column("frame_time", "ms").values.push_back(kFrame * 1e3);
            run.column("send_period", "ms").values.push_back(kSendPeriod * 1e3);
            run.column("received").values.push_back(heard ? 1 : 0);
            run.column("strength", "counts").values.push_back(heard ? row.range : kNothing);
            run.column("bearing_rad", "rad").values.push_back(heard ? row.bearing : kNothing);
            run.column("order").values.push_back(pair + 1);
        }
        experiment.runs.push_back(std::move(run));
        if (options.done) options.done(experiment.runs.size(), static_cast<std::size_t>(pairs));
    }
    return experiment;
}

}  // namespace puckloop::gap::emulate
