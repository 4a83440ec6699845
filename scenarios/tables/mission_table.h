#pragma once
// The table [mission] of a scenario.

#include "scenarios/description/scenario.h"
#include "scenarios/values/reader.h"

#include <filesystem>

namespace puckloop::scenarios {

/// Sets `mission` or `mission_program` of the scenario, neither where there is no such table. `period`: of
/// the recording, s; a step is a multiple of it. Throws InputError.
void read_mission(Reader& top, double period, Scenario& scenario);

/// The same of a file, whatever else is in it, in place of what the scenario had. Throws InputError, also
/// where there is none.
void read_mission_of(const std::filesystem::path& file, double period, Scenario& scenario);

}  // namespace puckloop::scenarios
