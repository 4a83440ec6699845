#pragma once
// The signals between the world's port `ir` and the infra-red medium: where everything stands. Both ends work
// the list out from the same description: "<name>.x" and "<name>.y" (m), "<name>.heading" (rad) of each
// robot, then of each movable box, then cylinder; ids index it.

#include "physics/description.h"

#include <algorithm>

namespace puckloop::physics {

inline constexpr std::size_t kPoseSignals = 3;  ///< x, y, heading

/// Names of what can move, in the order of their signals.
inline std::vector<std::string> moving_names(const World& world) {
    std::vector<std::string> names;
    const auto add = [&names](const auto& things) {
        for (const auto& thing : things)
            if (thing.movable) names.push_back(thing.name);
    };
    for (const Robot& robot : world.robots)
        names.push_back(robot.name);
    add(world.boxes);
    add(world.cylinders);
    return names;
}

inline std::vector<std::string> pose_signal_names(const World& world) {
    std::vector<std::string> names;
    for (const std::string& name : moving_names(world))
        for (const char* what : {".x", ".y", ".heading"})
            names.push_back(name + what);
    return names;
}

/// The world publishes poses, and a medium is needed, when any robot carries a board.
inline bool has_rab(const World& world) {
    return std::any_of(world.robots.begin(), world.robots.end(), [](const Robot& r) { return r.rab; });
}

}  // namespace puckloop::physics
