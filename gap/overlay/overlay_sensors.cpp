#include "gap/overlay/overlay_sensors.h"

#include "gap/models/model.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace puckloop::gap {

namespace {

using Values = std::map<std::string, double>;

/// Mean age that comes about by itself, where [nominal] does not tell it.
struct Own {
    const char* parameter;
    double seconds;
};
constexpr std::array<Own, 2> kOwn{{
    {"proximity.age", 0.5 / 63.015},  // half a period of the library's sampling (e-puck facts 5.1)
    {"ground.lag", 0.005},            // half of ground.period
}};

constexpr const char* kSession = "accelerometer.session_bias";
constexpr std::size_t kAxes = 3;

double take(Values& fitted, const std::string& name, double fallback) {
    const auto place = fitted.find(name);
    if (place == fitted.end()) return fallback;
    const double value = place->second;
    fitted.erase(place);
    return value;
}

void ages(const Experiment& experiment, Values& fitted, Values& simulator) {
    for (const Own& own : kOwn) {
        const auto stated = experiment.nominal.find(own.parameter);
        const bool told = stated != experiment.nominal.end();
        if (!told && !fitted.contains(own.parameter)) continue;
        const double made = told ? stated->second : own.seconds;
        simulator[own.parameter] = std::max(take(fitted, own.parameter, made) - made, 0.0);
    }
}

/// The first session's zero is accelerometer.bias; the others are fitted as differences to it.
void sessions(const Experiment& experiment, Values& fitted, Values& simulator) {
    std::array<std::vector<double>, kAxes> zeros;
    for (auto place = fitted.lower_bound(kSession); place != fitted.end();) {
        if (!place->first.starts_with(kSession)) break;
        const auto axis = static_cast<std::size_t>(place->first.back() - '0');
        if (axis < kAxes) zeros[axis].push_back(place->second);
        place = fitted.erase(place);
    }
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
        if (zeros[axis].empty()) continue;
        zeros[axis].push_back(0.0);
        const auto n = static_cast<double>(zeros[axis].size());
        double mean = 0.0, squares = 0.0;
        for (const double zero : zeros[axis])
            mean += zero / n;
        for (const double zero : zeros[axis])
            squares += (zero - mean) * (zero - mean);
        const std::string bias = fmt::format("accelerometer.bias{}", axis);
        const double first = take(fitted, bias, experiment.nominal_or(bias, 0.0));
        simulator[bias] = first + mean;
        simulator[fmt::format("accelerometer.session_spread{}", axis)] = std::sqrt(squares / (n - 1));
    }
}

/// A run in the middle of the measured ones stands this far from the run of which the simulator is right.
void series(const Experiment& experiment, Values& fitted, Values& simulator) {
    if (!fitted.contains("proximity.order_zero")) return;
    double first = INFINITY, last = -INFINITY;
    for (const Run& run : experiment.runs)
        for (const double order : run.column("order")) {
            first = std::min(first, order);
            last = std::max(last, order);
        }
    const double half = last > first ? (last - first) / 2 : 0.0;
    simulator["proximity.order"] = -take(fitted, "proximity.order_zero", 0.0) * half;
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
    return std::any_of(kOwn.begin(), kOwn.end(), [&](const Own& own) { return parameter == own.parameter; });
}

}  // namespace puckloop::gap
