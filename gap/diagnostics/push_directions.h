#pragma once
// Where pushes go. By chance they go any way in the room and about the robot, turn it either way, and have
// nothing to do with the push before.

#include <string>
#include <vector>

namespace puckloop::gap {

/// What a push did. NaN where no sum shows it.
struct Push {
    bool begins = false;      ///< the first of its run
    double x = 0.0, y = 0.0;  ///< in the room
    double heading = 0.0;     ///< of the robot in that row, rad
    double turned = 0.0;      ///< about the axle, rad
};

/// One thing that could be common to pushes.
struct PushDirection {
    std::string where;      ///< "against the push before", "along one line of the room", ...
    double pushes = 0.0;    ///< of which it holds
    double expected = 0.0;  ///< of which it would hold by chance
    double p_value = 1.0;   ///< of so many by chance, not corrected
};

/// All that is asked.
std::vector<PushDirection> push_directions(const std::vector<Push>& pushes);

}  // namespace puckloop::gap
