#pragma once
// The cameras of the robots' Linux boards and main boards.

#include "run/plan/setup.h"

#include <nlohmann/json_fwd.hpp>

#include <cstddef>

namespace puckloop::tools {

/// Adds the cameras of robot number `index`, and what they look at in `world`, to the description `spec` of
/// its Linux node, if it has any.
void add_cameras(const RunSetup& setup, std::size_t index, const nlohmann::json& world, nlohmann::json& spec);

/// The same for the camera of the main board, whose node's description `spec` is; and its link to the world.
void add_board_camera(RunSetup& setup, std::size_t index, const nlohmann::json& world, nlohmann::json& spec);

}  // namespace puckloop::tools
