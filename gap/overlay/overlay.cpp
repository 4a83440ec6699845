// A verdict's causes as an overlay: [parameters], [uart], [linux] and [clock] are what `puckloop run --model`
// takes, [measurement] what belongs to the measuring chain or has no counterpart in a run; `run` says that it
// passes over it.

#include "gap/overlay/overlay.h"
#include "gap/kinds/columns.h"
#include "gap/overlay/overlay_parts.h"
#include "physics/description/parameters.h"
#include "scenarios/tables/world_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace puckloop::gap {

namespace {

bool in_simulator(std::string_view parameter) {
    int index = -1;
    return physics::find_parameter(parameter, index) != nullptr;
}

/// One line, whatever the text holds: TOML knows no control characters in comments.
std::string comment(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, ' ');
    return "# " + text + "\n";
}

constexpr double kLeastSlip = 1e-3;  // of inverse_friction: no floor holds better

/// What the world model cannot take is cut to its range, and said.
std::string parameter_line(const std::string& name, double value) {
    int index = -1;
    const auto* info = physics::find_parameter(name, index);
    const double taken = std::clamp(value, info->min, info->max);
    std::string text;
    if (taken != value)
        text = comment(fmt::format("{} = {:.6g}{}{} was found or stated; the simulator takes {:g} to {:g}",
                                   name, value, unit_suffix(info->unit),
                                   made_by_firmware(name) ? ", less what firmware and host make," : "",
                                   info->min, info->max));
    return text + fmt::format("\"{}\" = {}\n", name, scenarios::parameter_text(name, taken));
}

/// Ratios of the motion model are radii of the world model.
void wheels(const Experiment& experiment, Values& fitted, Values& simulator) {
    const auto larger = take(fitted, "wheel_scale"), apart = take(fitted, "wheel_mismatch");
    if (!larger && !apart) return;
    const double scale = 1 + larger.value_or(0), mismatch = apart.value_or(0);
    const double both =
        experiment.nominal_or("robot.wheel_radius", physics::Parameters().robot.wheel_radius_left);
    simulator["robot.wheel_radius_left"] =
        experiment.nominal_or("robot.wheel_radius_left", both) * scale * (1 - mismatch);
    simulator["robot.wheel_radius_right"] =
        experiment.nominal_or("robot.wheel_radius_right", both) * scale * (1 + mismatch);
}

/// The ground board's place and height over the floor.
void ground_board(const Experiment& experiment, Values& fitted, Values& simulator) {
    const physics::GroundParameters drawn = physics::Parameters().ground;
    const auto move = [&](double by, const std::string& place, double neutral) {
        if (by != 0) simulator[place] = experiment.nominal_or(place, neutral) + by;
    };
    move(take(fitted, "ground.forward_error").value_or(0.0), "ground.x", drawn.x);
    move(take(fitted, "ground.raised").value_or(0.0), "ground.height", drawn.height);
    const double aside = take(fitted, "ground.left_error").value_or(0.0);
    for (std::size_t i = 0; i < physics::kGroundSensors; ++i)
        move(aside, fmt::format("ground.y{}", i), drawn.y[i]);
}

/// Moves what a run can have out of `fitted`: the world's parameters into `simulator`, the others into TOML
/// tables.
std::string translated(const Experiment& experiment, Values& fitted, Values& simulator) {
    wheels(experiment, fitted, simulator);
    rab_overlay(fitted, simulator);
    ground_board(experiment, fitted, simulator);
    sensors_overlay(experiment, fitted, simulator);
    for (const auto& [name, value] : fitted)
        if (in_simulator(name)) simulator[name] = value;
    std::erase_if(fitted, [](const auto& one) { return in_simulator(one.first); });
    if (const auto slip = take(fitted, "inverse_friction"))
        simulator["contact.mu"] = simulator["contact.mu_lateral"] = 1 / std::max(*slip, kLeastSlip);
    return links_overlay(experiment.nominal, fitted);
}

}  // namespace

bool overlay_takes(const std::string& parameter) {
    // What is cut or lost again is so only where something is.
    Values fitted{{parameter, 0.5}, {"timing.truncation", 0.5}, {"command.loss", 0.5}}, simulator;
    (void)translated({}, fitted, simulator);
    return !fitted.contains(parameter);
}

std::optional<double> take(Values& fitted, const std::string& name) {
    const auto taken = fitted.extract(name);
    return taken.empty() ? std::nullopt : std::optional(taken.mapped());
}

std::string overlay_toml(const Experiment& experiment, const Verdict& verdict) {
    Values fitted;
    std::string text = comment("Overlay of a measured experiment: " + experiment.title) +
                       comment(fmt::format("Verdict: {}", decision_name(verdict.decision)));
    for (const Cause& cause : verdict.causes) {
        text += comment(fmt::format("{} ({}): {}", cause.name, cause.number, cause.sentence));
        for (const FittedParameter& parameter : cause.parameters)
            fitted[parameter.name] = parameter.value;
    }
    Values simulator;
    const std::string tables = translated(experiment, fitted, simulator);
    // What the experiment says of its robot holds for the scenario as well.
    for (const auto& [name, value] : experiment.nominal)
        if (in_simulator(name)) simulator.emplace(name, value);
    text += "\n[parameters]\n";
    for (const auto& [name, value] : simulator)
        text += parameter_line(name, value);
    text += tables;
    text += extension_toml(verdict.extension);
    if (!fitted.empty())
        text += "\n# Of the measuring chain, or without a counterpart in the world model.\n[measurement]\n";
    for (const auto& [name, value] : fitted)
        text += fmt::format("\"{}\" = {:.9g}\n", name, value);
    return text;
}

}  // namespace puckloop::gap
