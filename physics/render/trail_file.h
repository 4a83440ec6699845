#pragma once
// Reads back pheromones.csv: what lay where when the run ended.

#include "physics/description/description.h"

#include <filesystem>
#include <vector>

namespace puckloop::physics {

/// One square of a trail.
struct TrailSquare {
    double x = 0.0, y = 0.0, side = 0.0;  ///< m: its middle, its side
    double grey = 0.0;                    ///< the floor's where it is full
    double strength = 0.0;                ///< 0 none .. 1 full
};

/// The squares of the latest time of each trail of `world`; a broken last line is ignored, a broken line
/// elsewhere or a missing file throws RunError.
std::vector<TrailSquare> read_trails(const World& world, const std::filesystem::path& file);

}  // namespace puckloop::physics
