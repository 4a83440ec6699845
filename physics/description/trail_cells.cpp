#include "physics/description/trail_cells.h"

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

TrailCells trail_cells(const Pheromone& pheromone, const Arena& arena) {
    constexpr double kFar = 1e9;        // m
    constexpr double kRounding = 1e-9;  // an arena of 1 m has a hundred squares of 1 cm
    double left = kFar, bottom = kFar, right = -kFar, top = -kFar;
    for (const Point& corner : arena.corners) {
        left = std::min(left, corner.x);
        right = std::max(right, corner.x);
        bottom = std::min(bottom, corner.y);
        top = std::max(top, corner.y);
    }
    return {left, bottom, std::ceil((right - left) / pheromone.cell - kRounding),
            std::ceil((top - bottom) / pheromone.cell - kRounding)};
}

}  // namespace puckloop::physics
