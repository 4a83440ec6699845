#pragma once
// What the cameras of a robot's Linux board look at: the world's scene, drawn.

#include "emu/camera/scenery.h"
#include "linuxboard/shim/devices/scenery.h"

#include <nlohmann/json_fwd.hpp>

#include <memory>

namespace puckloop::tools {

/// `spec`: {"world": the world's description, "robot": its number, "kinds": "omni" or "front" of each
/// camera}. Throws InputError.
std::unique_ptr<linuxboard::Scenery> make_scenery(const nlohmann::json& spec);

/// What a main board's camera looks at, from {"world": a description, "robot": its number,
/// "turned": it lies on its side}. Throws InputError.
std::unique_ptr<camera::Scenery> make_board_scenery(const nlohmann::json& spec);

}  // namespace puckloop::tools
