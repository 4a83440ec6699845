#pragma once
// The [[fault]] tables of a scenario.

#include "base/toml_file.h"
#include "scenarios/scenario.h"

#include <string>

namespace puckloop::scenarios {

/// Reads one fault; robots, TAMs and the coordinator are known already. `index` counts from 0. Throws
/// InputError with file and line.
cosim::FaultSpec read_fault(const std::string& file, std::size_t index, const TomlValue& table,
                            const Scenario& scenario);

}  // namespace puckloop::scenarios
