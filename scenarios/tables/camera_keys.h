#pragma once
// The keys of [robot.linux] and [robot.pic] that are about cameras.

#include "scenarios/description/scenario.h"
#include "scenarios/values/reader.h"

namespace puckloop::scenarios {

/// `cameras`, `camera_devices`, `save_frames`. Throws InputError with file and line.
void read_cameras(Reader& reader, LinuxBoard& board);

/// `camera` of [robot.pic]: "po3030k", "po6030k", "po8030d", or empty where it is "none" or nothing.
std::string read_board_camera(Reader& reader);

}  // namespace puckloop::scenarios
