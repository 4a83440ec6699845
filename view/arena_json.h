#pragma once
// A world as a page draws it.

#include "physics/description/description.h"

#include <string>

namespace puckloop::view {

/// JSON: "corners", "floor" (grey 0..1), "fixed" and "things" (shapes), "patches", "lamps", "speakers",
/// "robots", "booths", "virtuals" (shapes that only robots sense). Metres and radians.
std::string arena_json(const physics::World& world);

}  // namespace puckloop::view
