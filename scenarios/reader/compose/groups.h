#pragma once
// [[group]] tables: many robots or things from one description.

#include "base/text/toml_file.h"
#include "scenarios/description/scenario.h"
#include "scenarios/values/reader.h"

#include <string>

namespace puckloop::scenarios {

/// Adds the units of one group to a scenario whose single things, robots and TAMs have been read: tables as
/// of [[robot]],
/// [[box]], [[cylinder]] or [[lamp]], with names, places and spread values of their own (docs/scenario.md).
/// What is drawn is drawn from streams of the scenario's seed. Throws InputError with file and line, also
/// where a unit finds no place.
void read_group(const std::string& file, const TomlValue& table, Scenario& scenario);

}  // namespace puckloop::scenarios
