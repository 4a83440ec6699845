// A verdict's causes as an overlay: [parameters] is what `puckloop run --model` takes, [measurement] what
// belongs to the measuring chain or has no counterpart in the world model; `run` says that it passes over it.

#include "gap/analyse.h"
#include "physics/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace puckloop::gap {

namespace {

using Values = std::map<std::string, double>;

double get(const Values& values, const std::string& name, double neutral) {
    const auto place = values.find(name);
    return place == values.end() ? neutral : place->second;
}

/// Ratios of the motion model are radii of the world model.
void wheels(const Experiment& experiment, const Values& fitted, Values& simulator) {
    if (!fitted.contains("wheel_scale") && !fitted.contains("wheel_mismatch")) return;
    const physics::Parameters defaults;
    const double scale = 1 + get(fitted, "wheel_scale", 0), mismatch = get(fitted, "wheel_mismatch", 0);
    const double both = get(experiment.nominal, "robot.wheel_radius", defaults.robot.wheel_radius_left);
    simulator["robot.wheel_radius_left"] =
        get(experiment.nominal, "robot.wheel_radius_left", both) * scale * (1 - mismatch);
    simulator["robot.wheel_radius_right"] =
        get(experiment.nominal, "robot.wheel_radius_right", both) * scale * (1 + mismatch);
}

}  // namespace

std::string overlay_toml(const Experiment& experiment, const Verdict& verdict) {
    Values fitted;
    std::string text = fmt::format("# Overlay of a measured experiment: {}\n# Verdict: {}\n",
                                   experiment.title, decision_name(verdict.decision));
    for (const Cause& cause : verdict.causes) {
        text += fmt::format("# {} ({}): {}\n", cause.name, cause.number, cause.sentence);
        for (const FittedParameter& parameter : cause.parameters)
            fitted[parameter.name] = parameter.value;
    }
    std::replace(text.begin(), text.end(), '\t', ' ');
    Values simulator, measuring;
    wheels(experiment, fitted, simulator);
    for (const auto& [name, value] : fitted) {
        int index = -1;
        if (name == "wheel_scale" || name == "wheel_mismatch") continue;
        if (name == "inverse_friction") {
            simulator["contact.mu"] = simulator["contact.mu_lateral"] = 1 / value;
        } else if (const auto* info = physics::find_parameter(name, index); info != nullptr) {
            simulator[name] = std::clamp(value, info->min, info->max);
        } else {
            measuring[name] = value;
        }
    }
    // What the experiment says of its robot holds for the scenario as well.
    for (const auto& [name, value] : experiment.nominal) {
        int index = -1;
        if (physics::find_parameter(name, index) != nullptr) simulator.emplace(name, value);
    }
    text += "\n[parameters]\n";
    for (const auto& [name, value] : simulator)
        text += fmt::format("\"{}\" = {:.9g}\n", name, value);
    if (!measuring.empty())
        text += "\n# Of the measuring chain, or without a counterpart in the world model.\n[measurement]\n";
    for (const auto& [name, value] : measuring)
        text += fmt::format("\"{}\" = {:.9g}\n", name, value);
    return text;
}

}  // namespace puckloop::gap
