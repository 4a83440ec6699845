#pragma once
// Reads back trajectory.csv and objects.csv: who was where, when.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::physics {

struct PathPoint {
    double seconds = 0.0, x = 0.0, y = 0.0, heading = 0.0;
};
/// In order of first appearance.
using Paths = std::vector<std::pair<std::string, std::vector<PathPoint>>>;

/// Rows "t_s,name,x_m,y_m,theta_rad" after one header line; a broken last line is ignored, a broken line
/// elsewhere or a missing file throws RunError.
Paths read_paths(const std::filesystem::path& file);

}  // namespace puckloop::physics
