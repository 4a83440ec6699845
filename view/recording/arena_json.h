#pragma once
// A world as a page draws it.

#include "physics/description/description.h"

#include <string>

namespace puckloop::view {

/// JSON: "corners", "floor" (grey 0..1), "fixed" and "things" (shapes), "patches", "lamps", "speakers",
/// "robots", "booths", "virtuals" (shapes that only robots sense), "trails" (pheromones: side of their
/// squares, grey where they are full). Metres, radians, and of speakers seconds.
std::string arena_json(const physics::World& world);

}  // namespace puckloop::view
