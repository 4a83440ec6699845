#include "gap/overlay/overlay_parts.h"

#include "gap/models/model.h"
#include "physics/description/parameters.h"
#include "physics/description/robot_constants.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace puckloop::gap {

namespace {

/// Mean age (s) that comes about by itself, where [nominal] does not give it.
constexpr std::pair<const char*, double> kOwn[] = {
    {"proximity.age", 0.5 / physics::kProximityRate},  // half a period of the library's sampling
    {"ground.lag", 0.005},                             // half of ground.period
};

constexpr const char* kSession = "accelerometer.session_bias";
constexpr std::size_t kAxes = 3;

void ages(const Experiment& experiment, Values& fitted, Values& simulator) {
    for (const auto& [parameter, own] : kOwn) {
        if (!experiment.nominal.contains(parameter) && !fitted.contains(parameter)) continue;
        const double made = experiment.nominal_or(parameter, own);
        simulator[parameter] = take(fitted, parameter).value_or(made) - made;
    }
}

/// The first session's zero is accelerometer.bias; the others are fitted as differences to it. A scenario's
/// run has the mean; which session was how far off is the laboratory's.
void sessions(const Experiment& experiment, Values& fitted, Values& simulator) {
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
        double sum = 0.0, count = 1.0;  // the first session's difference is 0
        for (auto place = fitted.lower_bound(kSession);
             place != fitted.end() && place->first.starts_with(kSession); ++place)
            if (place->first.ends_with(static_cast<char>('0' + axis))) {
                sum += place->second;
                ++count;
            }
        if (sum == 0.0) continue;
        const std::string bias = fmt::format("accelerometer.bias{}", axis);
        simulator[bias] = take(fitted, bias).value_or(experiment.nominal_or(bias, 0.0)) + sum / count;
    }
}

/// A scenario's run is one in the middle of the measured ones: the drift up to there is its scale, the rest
/// the laboratory's.
void series(const Experiment& experiment, Values& fitted, Values& simulator) {
    if (!fitted.contains("proximity.order_zero")) return;
    const auto [first, last] = experiment.range("order");
    const double half = last > first ? (last - first) / 2 : 0.0;
    const std::string scale = "proximity.scale";
    const double neutral = experiment.nominal_or(scale, physics::Parameters().proximity.scale);
    const double middle = -fitted["proximity.order_zero"] * half;
    simulator[scale] = take(fitted, scale).value_or(neutral) * (1 + fitted["proximity.order_drift"] * middle);
}

/// Which sensors the pulses reach the model sees in the data.
void pulses(const Experiment& experiment, const Values& fitted, Values& simulator) {
    if (!fitted.contains("proximity.interference_rate") || experiment.runs.empty()) return;
    for (const auto& [name, value] : make_model(experiment)->implied())
        simulator[name] = value;
}

}  // namespace

void sensors_overlay(const Experiment& experiment, Values& fitted, Values& simulator) {
    ages(experiment, fitted, simulator);
    sessions(experiment, fitted, simulator);
    series(experiment, fitted, simulator);
    pulses(experiment, fitted, simulator);
}

bool made_by_firmware(const std::string& parameter) {
    return std::ranges::any_of(kOwn, [&](const auto& own) { return parameter == own.first; });
}

}  // namespace puckloop::gap
