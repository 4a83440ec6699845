#pragma once
// What the wheels did within each row of a drive, as a run's terms without a mechanism see it
// (physics/robot/extension.h): a row may begin a turn, hold a stop, or go half round.
//
// Deviations: 1. where only a counter was logged, a wheel's speed is even between two rows. 2. Steps more
// than 0.2 s apart count as driven throughout. 3. Where in a step a command comes is not known: the last step
// is taken to come half an interval before the wheel is stopped.

#include "gap/models/model.h"
#include "gap/models/motion_path.h"
#include "physics/description/parameters.h"

#include <cstdint>
#include <vector>

namespace puckloop::gap {

/// Adds the moments of all rows of `path`. `late`: s by which rows see the wheels late; `metre`: of a step;
/// `first`: number of the path's first row.
void add_wheel_moments(const Path& path, double late, double metre, const physics::BodyParameters& robot,
                       std::uint32_t first, std::vector<WheelMoment>& to);

}  // namespace puckloop::gap
