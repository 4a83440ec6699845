#pragma once
// The keys of a region of the floor: centre, and shape = "disc" with radius, or "rectangle" with size.

#include "missions/mission.h"
#include "scenarios/values/reader.h"

namespace puckloop::scenarios {

/// Throws InputError: a side that is not above 0 m and at most 1000 m, a key of the other shape.
missions::Region read_region(Reader& reader);

}  // namespace puckloop::scenarios
