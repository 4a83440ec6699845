#pragma once
// A picture of a run: arena, things, lamps, floor, the robots' paths with time marks, robots at start and
// end.

#include "physics/description/description.h"

#include <filesystem>

namespace puckloop::physics {

/// Reads trajectory.csv (and objects.csv, if things moved, and tams.csv, if there are any) in `directory` and
/// writes trajectory.svg there. A half-written last line, as a run that died may leave it, is ignored.
/// Throws RunError.
void write_trajectory_svg(const World& world, const std::filesystem::path& directory);

}  // namespace puckloop::physics
