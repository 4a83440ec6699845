#pragma once
// The keys of [robot.linux] that are about cameras.

#include "scenarios/reader.h"
#include "scenarios/scenario.h"

namespace puckloop::scenarios {

/// `cameras`, `camera_devices`, `save_frames`. Throws InputError with file and line.
void read_cameras(Reader& reader, LinuxBoard& board);

}  // namespace puckloop::scenarios
