#pragma once
// The cameras of the robots' Linux boards and main boards.

#include "run/description/run_setup.h"

#include <cstddef>

namespace puckloop::tools {

/// Adds the cameras of robot number `index`, and what they look at, to the description `spec` of its Linux
/// node, if it has any.
void add_cameras(const RunSetup& setup, std::size_t index, LinuxProgram& spec);

/// The same for the camera of the main board, whose node's description `spec` is; and its link to the world.
void add_board_camera(RunSetup& setup, std::size_t index, MainBoard& spec);

}  // namespace puckloop::tools
