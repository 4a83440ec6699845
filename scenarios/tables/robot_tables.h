#pragma once
// The [[robot]] tables of a scenario.

#include "base/text/toml_file.h"
#include "scenarios/description/scenario.h"
#include "scenarios/values/reader.h"

#include <string>

namespace puckloop::scenarios {

/// Reads one robot and adds it, boards and body. Throws InputError with file and line.
void read_robot(const std::string& file, const TomlValue& table, Scenario& scenario);

}  // namespace puckloop::scenarios
