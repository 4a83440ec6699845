#pragma once
// The [[tam]] tables of a scenario.

#include "base/text/toml_file.h"
#include "scenarios/description/scenario.h"

#include <string>

namespace puckloop::scenarios {

/// Reads one TAM and adds it, board and booth. Throws InputError with file and line.
void read_tam(const std::string& file, const TomlValue& table, Scenario& scenario);

}  // namespace puckloop::scenarios
