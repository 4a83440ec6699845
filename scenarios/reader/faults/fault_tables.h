#pragma once
// The [[fault]] tables of a scenario, and faults of the command line.

#include "base/text/toml_file.h"
#include "scenarios/description/scenario.h"

#include <string>
#include <string_view>

namespace puckloop::scenarios {

/// Reads one fault; robots, TAMs and the coordinator are known already. `index` counts from 0. Throws
/// InputError with file and line.
cosim::FaultSpec read_fault(const std::string& file, std::size_t index, const TomlValue& table,
                            const Scenario& scenario);

/// Adds a fault given in one line (fault_words.h).
void add_fault(std::string_view words, Scenario& scenario);

}  // namespace puckloop::scenarios
