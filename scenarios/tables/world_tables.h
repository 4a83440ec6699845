#pragma once
// The tables of a scenario that describe the world: arena, things, lamps, floor, parameters.

#include "physics/description/description.h"
#include "scenarios/values/reader.h"

#include <map>
#include <string>

namespace puckloop::scenarios {

/// Reads [arena], [[wall]], [[box]], [[cylinder]], [[lamp]], [[speaker]], [[floor_patch]], [light] and
/// [parameters].
physics::World read_world(Reader& top);

/// A [parameters] table: dotted names of the physical parameters, each with its unit.
std::map<std::string, double> read_parameters(const std::string& file, const std::string& where,
                                              const TomlValue& table);

/// What its values are in; a number for a parameter that does not exist.
Dimension dimension_of_parameter(const std::string& name);
/// A physical parameter's value as such a table has it: with its unit where one is required.
std::string parameter_text(const std::string& name, double value);

}  // namespace puckloop::scenarios
