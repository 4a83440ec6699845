#pragma once
// The table [mission] of a scenario.

#include "missions/mission.h"
#include "scenarios/reader/reader.h"

#include <filesystem>
#include <optional>

namespace puckloop::scenarios {

/// None where there is no such table. `period`: of the recording, s; a step is a multiple of it. Throws
/// InputError.
std::optional<missions::Mission> read_mission(Reader& top, double period);

/// [mission] of a file, whatever else is in it. Throws InputError, also where there is none.
missions::Mission read_mission_of(const std::filesystem::path& file, double period);

}  // namespace puckloop::scenarios
