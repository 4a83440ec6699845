#include "selftest/emulate/record.h"

#include "base/error.h"
#include "base/random.h"
#include "physics/description/parameters.h"
#include "selftest/emulate/plans_sensors.h"
#include "selftest/emulate/record_rab.h"
#include "selftest/emulate/record_serial.h"
#include "selftest/emulate/surroundings.h"
#include "selftest/emulate/wave_floor.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <stdexcept>

namespace puckloop::gap::emulate {

namespace {

constexpr double kRecordedDegree = std::numbers::pi / 180;
constexpr double kPlaceNoise = 0.0005, kPlaceQuantum = 1e-4;                 // m, of the tracker
constexpr double kAngleNoise = 0.2 * kRecordedDegree, kAngleQuantum = 1e-4;  // rad
constexpr double kJigNoise = 1e-6;                                           // m: a measuring table's
constexpr double kHostNoise = 2e-4;                                          // s, of the host's time stamps
constexpr double kTransferTime = 1.9e-4;  // s: address, register or value, STOP at 100 kHz
constexpr double kClockReading = 1e-6;    // s: what the recorder's loop takes beside its sleeps
constexpr double kMostSlanting = 65 * kRecordedDegree, kFurthest = 0.11;
constexpr double kClearOfEdge = 0.008;  // m: a row 0.1 s late is still on the same stripe
/// Commands reach the motors this much after the row's time; found by fitting unchanged robots.
constexpr double kCommandLatency = 0.0033;  // s
/// Of a reading at the row's time, on average: it was sampled up to 13 ms before it was asked for.
constexpr double kOwnAge = 0.005;  // s
/// Of the ground row: its period, the world's step, the reading of the bus before the row's time.
constexpr double kOwnLag = 0.009;  // s
/// Steps that a start makes too few: the first comes a period of the timer late, and the coils are cut before
/// the rotor has made the last. What the world model's own poses say of unchanged robots: 1.0 to 1.2.
constexpr double kStartLoss = 1.1;

WrittenRun motion_run(const std::vector<Row>& rows, RandomStream& noise) {
    WrittenRun run;
    for (const Row& r : rows) {
        const auto blurred = [&](double value, double sd, double quantum) {
            return std::round((value + sd * noise.normal()) / quantum) * quantum;
        };
        run.column("t_s", "s").values.push_back(r.powered);
        run.column("x_m", "m").values.push_back(blurred(r.x, kPlaceNoise, kPlaceQuantum));
        run.column("y_m", "m").values.push_back(blurred(r.y, kPlaceNoise, kPlaceQuantum));
        run.column("theta_rad", "rad").values.push_back(blurred(r.theta, kAngleNoise, kAngleQuantum));
        run.column("cmd_left", "steps/s").values.push_back(r.left);
        run.column("cmd_right", "steps/s").values.push_back(r.right);
    }
    return run;
}

WrittenRun proximity_run(const std::vector<Row>& rows, const Act& act, RandomStream& noise) {
    const physics::Parameters nominal;
    const bool lamp = act.conditions.at("light") == "lamp", drives_on = act.conditions.contains("drive");
    WrittenRun run;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const bool drives = drives_on && steady(rows, k);
        if (!drives && !settled(rows, k)) continue;
        const Row& r = rows[k];
        const double speed = drives ? (r.left + r.right) / 2 : 0.0;  // steps/s
        for (std::size_t i = 0; i < physics::kProximitySensors; ++i) {
            const double c = std::cos(r.theta), s = std::sin(r.theta);
            const double x = r.x + c * nominal.proximity.x[i] - s * nominal.proximity.y[i];
            const double way = std::remainder(r.theta + nominal.proximity.direction[i], 2 * std::numbers::pi);
            if (std::abs(way) > kMostSlanting) continue;
            const double gap = (kWallFace - x) / std::cos(way) + kJigNoise * noise.normal();
            if (gap > kFurthest) continue;
            const auto others = [&](std::size_t sensor) { return r.ps[sensor % physics::kProximitySensors]; };
            run.column("t_s", "s").values.push_back(r.powered);
            run.column("sensor").values.push_back(static_cast<double>(i));
            run.column("distance_m", "mm").values.push_back(gap * 1e3);
            run.column("angle_rad", "deg").values.push_back(-way / kRecordedDegree);
            run.column("ambient").values.push_back(lamp ? 1 : 0);
            run.column("reading", "counts").values.push_back(r.ps[i]);
            // Of the exchange before, standing too: a reading is ambient minus lit, and would share the
            // noise.
            run.column("ambient_reading", "counts").values.push_back(rows[k - 1].amb[i]);
            run.column("pair_reading", "counts").values.push_back(others(i + 4));
            run.column("neighbour_reading", "counts").values.push_back(others(i + 1) + others(i + 7));
            run.column("motor_speed", "steps/s").values.push_back(speed);
            run.column("velocity", "mm/s")
                .values.push_back(-speed * kMetresPerStep * c / std::cos(way) * 1e3);
        }
    }
    return run;
}

/// Between printed stripes: rows well inside one, at even speed.
WrittenRun stripes_run(const std::vector<Row>& rows) {
    const physics::Parameters nominal;
    WrittenRun run;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        if (!steady(rows, k)) continue;  // a start or stop tips the robot a little
        const Row& r = rows[k];
        for (std::size_t i = 0; i < physics::kGroundSensors; ++i) {
            const double x =
                r.x + std::cos(r.theta) * nominal.ground.x - std::sin(r.theta) * nominal.ground.y[i];
            if (std::isnan(r.gs[i]) || near_edge(x, kClearOfEdge)) continue;
            run.column("t_s", "s").values.push_back(r.powered);
            run.column("sensor").values.push_back(static_cast<double>(i));
            run.column("grey").values.push_back(stripe_grey(x));
            run.column("reading", "counts").values.push_back(r.gs[i]);
            run.column("grey_rate", "1/m").values.push_back(0);
        }
    }
    return run;
}

/// Over waves: rows of the drives, 0.3 s after the last change of speed, since starts and stops tip the
/// robot. They are read before their command goes out.
WrittenRun waves_run(const std::vector<Row>& rows) {
    constexpr std::size_t kLevelRows = 4;
    const physics::Parameters nominal;
    WrittenRun run;
    for (std::size_t k = kLevelRows; k < rows.size(); ++k) {
        const Row& r = rows[k];
        const double steps = rows[k - 1].left;
        bool level = steps != 0.0;
        for (std::size_t i = k - kLevelRows; i < k; ++i)
            level = level && rows[i].left == steps;
        if (!level) continue;
        const double c = std::cos(r.theta), s = std::sin(r.theta);
        for (std::size_t i = 0; i < physics::kGroundSensors; ++i) {
            if (std::isnan(r.gs[i])) continue;
            const double x = r.x + c * nominal.ground.x - s * nominal.ground.y[i];
            run.column("t_s", "s").values.push_back(r.powered);
            run.column("sensor").values.push_back(static_cast<double>(i));
            run.column("grey").values.push_back(wave_grey(x));
            run.column("reading", "counts").values.push_back(r.gs[i]);
            run.column("grey_rate", "1/m").values.push_back(wave_slope(x) * c);
            run.column("speed", "m/s").values.push_back(steps * kMetresPerStep);
        }
    }
    return run;
}

WrittenRun ground_run(const std::vector<Row>& rows, const Act& act) {
    const bool waves = act.conditions.at("drive").starts_with("waves");
    return waves ? waves_run(rows) : stripes_run(rows);
}

WrittenRun timing_run(const std::vector<Row>& rows, RandomStream& noise) {
    constexpr double kBytes = 84;
    constexpr double kGroundTransfers = 12;  // six registers, each a write and a read
    WrittenRun run;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        run.column("seq").values.push_back(static_cast<double>(k));
        const double stamp = rows[k].answered + kHostNoise * noise.normal();
        run.column("t_host_s", "s").values.push_back(rows[k].ok ? stamp : std::nan(""));
        run.column("nominal_period", "ms").values.push_back(100);
        run.column("bytes").values.push_back(kBytes);
        run.column("frame_ok").values.push_back(rows[k].ok ? 1 : 0);
        run.column("i2c_reads").values.push_back(std::isnan(rows[k].gs[0]) ? 0 : kGroundTransfers);
    }
    return run;
}

}  // namespace

namespace {

WrittenExperiment performed(std::string_view kind, const RecordOptions& options) {
    if (kind == "rab") return record_rab(options);
    if (kind == "serial") return record_serial(options);
    const std::vector<Act> acts = acts_of(kind, options.seed, options.brief);
    WrittenExperiment experiment;
    experiment.kind = std::string(kind);
    if (kind == "motion")
        experiment.nominal = {{"firmware.agenda", 0},
                              {"command.latency", kCommandLatency},
                              {"firmware.start_loss", kStartLoss}};
    if (kind == "proximity") experiment.nominal = {{"proximity.age", kOwnAge}};
    if (kind == "timing")
        experiment.nominal = {{"timing.i2c_stretch", kTransferTime}, {"timing.extra_period", kClockReading}};
    if (kind == "proximity") experiment.instruments = {{"reading", NAN, 4095, 1}};
    if (kind == "ground") experiment.nominal = {{"ground.lag", kOwnLag}};
    // The sensors saturate at 967, and the converter's noise comes after that.
    if (kind == "ground") experiment.instruments = {{"reading", 0, 963, 1}};
    if (kind == "microphone") {
        // The loudspeaker's sound is noise: one window's level scatters by 12 %.
        experiment.nominal = {{"microphone.gaussian", 1}};
        experiment.instruments = {{"level", 0, 4095, 1}};
    }
    if (kind == "accelerometer")
        for (const char* axis : {"ax", "ay", "az"})
            experiment.instruments.push_back({axis, 0, 4095, 1});
    RandomStream noise(options.seed, "laboratory");
    for (std::size_t k = 0; k < acts.size(); ++k) {
        const auto rows = perform(options.robot, acts[k], options.tools, options.seed + k,
                                  options.scratch / fmt::format("act{:02}", k + 1));
        WrittenRun run;
        if (kind == "motion") run = motion_run(rows, noise);
        if (kind == "motion" && !options.brief) note_surroundings(acts[k], rows, run);
        if (kind == "proximity") run = proximity_run(rows, acts[k], noise);
        if (kind == "ground") run = ground_run(rows, acts[k]);
        if (kind == "timing") run = timing_run(rows, noise);
        if (kind == "microphone") run = microphone_run(rows);
        if (kind == "accelerometer") run = accelerometer_run(rows, acts[k]);
        run.conditions = acts[k].conditions;
        run.column("order").values.assign(run.rows(), static_cast<double>(k + 1));
        experiment.runs.push_back(std::move(run));
        if (options.done) options.done(k + 1, acts.size());
    }
    return experiment;
}

}  // namespace

WrittenExperiment record(std::string_view kind, const RecordOptions& options) {
    WrittenExperiment experiment = performed(kind, options);
    experiment.brief = options.brief;
    return experiment;
}

}  // namespace puckloop::gap::emulate
