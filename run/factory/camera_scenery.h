#pragma once
// What the cameras of a robot's Linux board look at: the world's scene, drawn.

#include "emu/camera/scenery.h"
#include "linuxboard/shim/devices/scenery.h"
#include "run/description/linux_program.h"
#include "run/description/main_board.h"

#include <memory>

namespace puckloop::tools {

std::unique_ptr<linuxboard::Scenery> make_scenery(const CameraViews& views);

/// What a main board's camera looks at.
std::unique_ptr<camera::Scenery> make_board_scenery(const BoardCamera& camera);

}  // namespace puckloop::tools
