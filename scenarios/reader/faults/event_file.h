#pragma once
// events.toml: what was done to a run, to be done again (`--events`).

#include "base/text/toml_file.h"
#include "scenarios/description/scenario.h"

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::scenarios {

/// The [[event]] tables of the file are in place of the scenario's; its [[fault]] tables, which a run
/// that a client drove had besides, come after the scenario's. There is nothing else in such a file. What
/// events name is checked by physics::check_events(), later. Throws InputError.
void apply_event_file(const std::filesystem::path& file, Scenario& scenario);

/// The [[fault]] tables of such a file as they are. Throws InputError for what is no TOML.
std::vector<TomlValue> fault_tables_of(const std::filesystem::path& file);

/// A fault's table as such a file has it.
std::string fault_toml(const TomlValue& table);

}  // namespace puckloop::scenarios
