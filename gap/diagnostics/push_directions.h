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

/// Most of the pushes lie where few should.
struct PushPattern {
    std::string where;      ///< "position x 0.4", "cmd left -400, cmd left in the previous row 400", "some
                            ///< runs", "rows that were as likely not pushed", or a direction: "against the
                            ///< push before", "along one line of the room"
    double pushes = 0.0;    ///< there, each by its probability
    double all = 0.0;       ///< pushes found anywhere
    double expected = 0.0;  ///< there, if they came by chance
    double p_value = 1.0;   ///< of so many there by chance
};

/// All that is asked of the directions; p values are not corrected. `all`: pushes found.
std::vector<PushPattern> push_directions(const std::vector<Push>& pushes, double all);

}  // namespace puckloop::gap
