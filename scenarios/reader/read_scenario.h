#pragma once
// From a file to a scenario. See docs/scenario.md.

#include "scenarios/description/scenario.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::scenarios {

/// What is decided before a scenario is read: values of its variables, and the seed by which places and
/// spreads of groups are drawn.
struct Settings {
    std::vector<std::string> variables{};  ///< "NAME=VALUE"
    std::optional<std::uint64_t> seed{};   ///< in place of the scenario's
    std::filesystem::path floor{};         ///< PNG file for the floor of an ARGoS experiment; empty: none
    double floor_scale = 0.0;              ///< of that, pixels a metre; 0: it covers the arena
    std::filesystem::path mission{};       ///< file whose [mission] counts; empty: the scenario's own
};

/// Reads and checks a scenario, TOML or, by its ending .argos or .xml, an ARGoS experiment; paths in it are
/// relative to the folder of the file that they are in. Throws InputError with file and line.
Scenario read_scenario(const std::filesystem::path& file, const Settings& settings = {});

/// Throws InputError if neither a duration nor a program ends the run: looked at when the command line's
/// changes have been made.
void check_ending(const Scenario& scenario);

/// Applies an overlay file (`--model`): parameters for all robots, or for one in [[robot]] tables; [uart],
/// [linux] and [clock] for all robots.
void apply_overlay(Scenario& scenario, const std::filesystem::path& file);

}  // namespace puckloop::scenarios
