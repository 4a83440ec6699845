#pragma once
// A term without a mechanism, as an overlay has it.

#include "physics/description/extension.h"
#include "scenarios/values/reader.h"

namespace puckloop::scenarios {

/// Reads one [[extension]] table; InputError with file and line for the first thing in it that is wrong.
physics::ExtensionTerm read_extension(const std::string& file, const TomlValue& table);

}  // namespace puckloop::scenarios
