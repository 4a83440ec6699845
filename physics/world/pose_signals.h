#pragma once
// The signals between the world's port `ir` and the infra-red medium: where everything stands. Both ends work
// the list out from the same description: "<name>.x" and "<name>.y" (m), "<name>.heading" (rad) of each
// robot, then of each movable box, then cylinder; ids index it.
//
// Where events change the world, more follow: one a robot or movable thing, 1 while it is out of the way
// (lifted, taken away), then kShapeSignals for each further body, fixed ones and those added later in turn.

#include "physics/description/description.h"
#include "physics/description/plan.h"

#include <algorithm>
#include <array>
#include <cmath>

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

/// A body's shape as signals: kind (Shape::Kind), x, y, heading, half length or radius, half width, height
/// (0: taken away), reflectivity.
inline constexpr std::size_t kShapeSignals = 8;
using ShapeValues = std::array<double, kShapeSignals>;

inline ShapeValues values_of(const Shape& shape) {
    const bool box = shape.kind == Shape::Kind::Box;
    return {box ? 1.0 : 0.0,
            shape.x,
            shape.y,
            std::atan2(shape.sine, shape.cosine),
            box ? shape.half_length : shape.radius,
            shape.half_width,
            shape.height,
            shape.reflectivity};
}
inline Shape shape_from(const ShapeValues& v) {
    if (v[0] == 0.0) return circle_shape(v[1], v[2], v[4], v[6], v[7]);
    return box_shape(v[1], v[2], v[3], 2 * v[4], 2 * v[5], v[6], v[7]);
}

/// Ids of the port's signals beyond the poses of `moving` bodies.
struct SceneSignals {
    std::size_t moving = 0;
    std::size_t out(std::size_t body) const { return kPoseSignals * moving + body; }
    /// `fixed`: the world's fixed thing `index`, else the movable thing that was added as number `index`.
    std::size_t shape(bool fixed, std::size_t index) const {
        return (kPoseSignals + 1) * moving + (2 * index + (fixed ? 0 : 1)) * kShapeSignals;
    }
};

/// Of virtual boards, to the infra-red medium alone: x, y, heading of each, from the last id downwards, so
/// that they are in nobody's way.
inline std::size_t virtual_board_signal(std::size_t board, std::size_t value) {
    constexpr std::size_t kLast = 0xFFFE;
    return kLast - (kPoseSignals * board + value);
}
inline bool is_virtual_board_signal(std::size_t id) {
    return id >= virtual_board_signal(kMostVirtualBoards - 1, kPoseSignals - 1);
}

/// The world publishes poses, and a medium is needed, when any robot carries a board.
inline bool has_rab(const World& world) {
    return std::any_of(world.robots.begin(), world.robots.end(), [](const Robot& r) { return r.rab; });
}

}  // namespace puckloop::physics
