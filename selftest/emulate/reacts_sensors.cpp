#include "selftest/emulate/reacts_sensors.h"

#include "physics/description/parameters.h"
#include "selftest/emulate/plans_sensors.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

namespace puckloop::gap::emulate {

namespace {

constexpr double kSensorStanding = 3.0;        // s: the mean of 25 windows is good to 2.4 %
constexpr double kSensorLook = 0.5;            // s after a row's time that are looked at
constexpr double kSettledRows = 0.45;          // s after which rows count
constexpr std::size_t kSensorPlacements = 24;  // of many every so-many-th, in order
constexpr double kSensorFine = 1e-4;           // m and rad: closer placements are one
constexpr double kLevel = 300.0;     // counts at 0.1 m, where nothing is stated (gap/models/microphone)
constexpr double kFarthest = 100.0;  // m
constexpr const char* kOpenFloor = "[arena]\nsize = [\"4 m\", \"4 m\"]\nwalls = false\n";

using Place = std::array<long, 4>;
using Places = std::map<Place, React>;

std::vector<React> some_of(Places& places) {
    std::vector<React> all;
    for (auto& [place, react] : places)
        all.push_back(std::move(react));
    return spread_of(all, kSensorPlacements);
}

void add_row(Places& places, const Place& place, const React& react, const Experiment& experiment,
             std::size_t run, std::size_t row, double longest) {
    React& known = places.try_emplace(place, react).first->second;
    const double t = value_of(experiment.runs[run], "t_s", row, NAN);
    known.timed = longest > kSensorStanding && !std::isnan(t);
    double& until = known.act.commands.back().seconds;
    if (known.timed) until = std::max(until, std::min(t + kSensorLook, longest));
    known.rows.push_back(run);
    known.rows.push_back(row);
}

/// What a standing robot's rows say once they have settled; about a row's time where that matters.
std::vector<double> settled(const std::vector<Row>& emulated, const React& react, const Run& run,
                            std::size_t measured, const std::function<double(const Row&)>& value) {
    if (react.timed) return standing(emulated, value_of(run, "t_s", measured, NAN), value);
    std::vector<double> values;
    for (const Row& row : emulated)
        if (row.t >= kSettledRows && row.ok && !std::isnan(value(row))) values.push_back(value(row));
    return values;
}

}  // namespace

std::vector<React> microphone_reacts(const Experiment& experiment, double longest, std::string& why) {
    const physics::MicrophoneParameters drawn = physics::Parameters().microphone;
    Places places;
    for (std::size_t r = 0; r < experiment.runs.size(); ++r)
        for (std::size_t i = 0; i < experiment.runs[r].rows; ++i) {
            const Run& run = experiment.runs[r];
            const double mic = value_of(run, "mic", i, 0), distance = value_of(run, "distance_m", i, NAN),
                         angle = value_of(run, "angle_rad", i, 0),
                         level = value_of(run, "amplitude", i, kLevel);
            if (!(mic >= 0 && mic < physics::kMicrophones) || !(distance > 0 && distance < kFarthest) ||
                std::isnan(angle) || !(level >= 0) || value_of(run, "motor_speed", i, 0) != 0.0)
                continue;
            React react;
            react.sensor = static_cast<std::size_t>(mic);
            const double way = drawn.direction[react.sensor] + angle;
            react.act.arena =
                kOpenFloor + speaker_table(drawn.x[react.sensor] + distance * std::cos(way),
                                           drawn.y[react.sensor] + distance * std::sin(way), level);
            react.act.commands = {{0, 0, 0}, {kSensorStanding, 0, 0}};
            add_row(places,
                    {static_cast<long>(mic), std::lround(distance / kSensorFine),
                     std::lround(angle / kSensorFine), std::lround(level)},
                    react, experiment, r, i, longest);
        }
    auto chosen = some_of(places);
    if (chosen.empty()) why = "no row of a standing robot with a loudspeaker's distance";
    return chosen;
}

std::vector<React> accelerometer_reacts(const Experiment& experiment, double longest, std::string& why) {
    int index = -1;
    const double steepest = physics::find_parameter("world.slope_x", index)->max;
    Places places;
    for (std::size_t r = 0; r < experiment.runs.size(); ++r)
        for (std::size_t i = 0; i < experiment.runs[r].rows; ++i) {
            const Run& run = experiment.runs[r];
            const double pitch = value_of(run, "pitch_rad", i, 0), roll = value_of(run, "roll_rad", i, 0);
            const double across = std::asin(std::cos(pitch) * std::sin(roll));
            const double moving = std::abs(value_of(run, "motor_speed", i, 0)) +
                                  std::abs(value_of(run, "acceleration", i, 0)) +
                                  std::abs(value_of(run, "lateral", i, 0));
            if (!(std::abs(pitch) <= steepest && std::abs(across) <= steepest) || moving != 0.0) continue;
            React react;
            react.act.shimmed = true;
            react.act.arena = kOpenFloor;
            react.act.slope_x = pitch;  // the robot looks along x
            react.act.slope_y = across;
            react.act.commands = {{0, 0, 0}, {kSensorStanding, 0, 0}};
            add_row(places, {std::lround(pitch / kSensorFine), std::lround(roll / kSensorFine), 0, 0}, react,
                    experiment, r, i, longest);
        }
    auto chosen = some_of(places);
    if (chosen.empty()) why = "no row of a robot that stands, tilted by 0.2 rad or less";
    return chosen;
}

void compare_microphone(const Experiment& experiment, const React& react, const Performed& performed,
                        const Performed& plain, std::vector<Comparison>& comparisons) {
    const auto value = [&](const Row& r) { return r.mic[react.sensor]; };
    for (std::size_t k = 0; k + 1 < react.rows.size(); k += 2) {
        const Run& run = experiment.runs[react.rows[k]];
        const std::size_t row = react.rows[k + 1];
        compare_reading(run.column("level")[row], settled(performed.rows, react, run, row, value),
                        settled(plain.rows, react, run, row, value), comparisons[0], comparisons[1]);
    }
}

void compare_accelerometer(const Experiment& experiment, const React& react, const Performed& performed,
                           const Performed& plain, std::vector<Comparison>& comparisons) {
    const char* const axes[] = {"ax", "ay", "az"};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto value = [&](const Row& r) { return r.acc[axis]; };
        for (std::size_t k = 0; k + 1 < react.rows.size(); k += 2) {
            const Run& run = experiment.runs[react.rows[k]];
            const std::size_t row = react.rows[k + 1];
            compare_reading(run.column(axes[axis])[row], settled(performed.rows, react, run, row, value),
                            settled(plain.rows, react, run, row, value), comparisons[axis],
                            comparisons[3 + axis]);
        }
    }
}

}  // namespace puckloop::gap::emulate
