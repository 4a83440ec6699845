#pragma once
// The drives of a good laboratory: lines both ways at several speeds, spins and circles and squares in both
// senses, hops, reversals, free drives; each twice, from another start heading.

#include "selftest/plain/plain_motion.h"

#include <string>
#include <vector>

namespace puckloop::gap::selftest {

struct PlannedDrive {
    std::string path;   ///< "line", "spin", "square", "circle", "hops", "reversals", "free"
    std::string sense;  ///< "forward", "backward", "ccw", "cw", "both"
    MotionScript script;
};

/// `one_circle`: only circles of one sense, which cannot tell a mismatch from another axle.
std::vector<PlannedDrive> planned_drives(RandomStream& random, bool one_circle);

}  // namespace puckloop::gap::selftest
