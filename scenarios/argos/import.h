#pragma once
// An ARGoS experiment file as the tables of a scenario. Conventions as ARGoS has them: metres, angles in
// degrees about z, y, x, a body's position is the middle of its base. docs/swarm.md states what becomes of
// what.
//
// Deviations: 1. everything stands upright on the floor. 2. A light's intensity is taken as a lamp's, as it
// is.

#include "base/text/toml_file.h"
#include "scenarios/argos/xml_file.h"

#include <filesystem>
#include <vector>

namespace puckloop::argos {

struct Options {
    std::filesystem::path floor{};  ///< PNG file in place of the floor that the file has; empty: none
    double pixels_per_metre = 0.0;  ///< of that; 0: it is stretched over the arena
};

struct Imported {
    TomlValue scenario;       ///< lines are those of the file
    std::vector<Note> notes;  ///< what is not taken over, by line
};

/// By its ending, .argos or .xml.
bool is_experiment(const std::filesystem::path& file);

/// Throws InputError with file and line: malformed XML, things and devices that do not exist here, numbers
/// that are none.
Imported import_experiment(const std::filesystem::path& file, const Options& options);

}  // namespace puckloop::argos
