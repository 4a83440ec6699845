#pragma once
// The squares that a trail is computed in: how many, where, and how far it may spread.

#include "physics/description/description.h"

namespace puckloop::physics {

/// Between two times at which a trail spreads, s.
inline constexpr double kSpreadInterval = 0.1;
/// check() refuses more, as each would cost more time than all robots.
inline constexpr double kMostTrailCells = 1e6;
inline constexpr double kMostSpread = 20.0;

struct TrailCells {
    double left = 0.0, bottom = 0.0;   ///< m
    double columns = 0.0, rows = 0.0;  ///< whole numbers, of any size
};
/// Squares that cover the arena, from its least x and y on.
TrailCells trail_cells(const Pheromone& pheromone, const Arena& arena);

/// What a square gives each neighbour in that interval, in shares of what it has more.
inline double spread_of(const Pheromone& pheromone) {
    return pheromone.diffusion * kSpreadInterval / (pheromone.cell * pheromone.cell);
}

}  // namespace puckloop::physics
