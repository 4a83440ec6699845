#pragma once
// What robots of one run did, in numbers: from where they were, as a tracker above the arena sees it.

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::gap::mission {

/// One robot's way; rising times.
struct Way {
    std::string robot;
    std::vector<double> t, x, y, heading;  ///< s, m, m, rad; `heading` is empty where none was given
};

/// Throws InputError with file and line.
std::vector<Way> read_track(const std::filesystem::path& file);

/// Means over robots and time, by windows of half a second, which a tracker's noise of some millimetres does
/// not fill.
struct Behaviour {
    double speed = 0.0;     ///< m/s, along the chord of a window
    double turning = 0.0;   ///< rad/s, without sign; NaN without headings
    double standing = 0.0;  ///< share of windows with less than 1 cm/s
    double nearest = 0.0;   ///< m to the nearest other robot; NaN of a single one
    double crowd = 0.0;     ///< m from the swarm's middle; NaN of a single one
    double cruise = 0.0;    ///< m/s: median speed of windows without a turn; NaN without headings
    double veer = 0.0;      ///< rad/s: mean turn to the left in these windows; NaN without headings
    double approach = 0.0;  ///< m: of the distances to the nearest robot, one in twenty is less
    double crossing = 0.0;  ///< m/s, of the swarm's middle; NaN of a single one
};
/// Throws InputError, naming `file`, for fewer than four windows in common.
Behaviour behaviour_of(const std::vector<Way>& ways, const std::filesystem::path& file);

}  // namespace puckloop::gap::mission
