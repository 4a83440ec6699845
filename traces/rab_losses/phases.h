#pragma once
// Boards that send in step: what one's sending does to the other's hearing then happens with each frame, or
// with none, for as long as they stay so.

#include "cosim/core/time.h"

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace puckloop::tools {

/// Frames of `follower` begin at the same place between two frames of `leader`.
struct PhaseLock {
    std::string leader, follower;
    std::size_t frames = 0;  ///< of the follower, that lie between two of the leader
    double period = 0.0;     ///< s: the leader's, median
    double phase = 0.0;      ///< share of the period, mean, [0, 1)
    double spread = 0.0;     ///< share of the period, circular standard deviation
};

/// A pair is locked whose spread is below this share of the period.
inline constexpr double kLockedSpread = 0.1;
/// Fewer frames show nothing.
inline constexpr std::size_t kFewestLocked = 20;

/// The locked pairs, in the order of their names; `starts` of frames by sender, rising. Intervals of more
/// than three periods, in which the leader paused, are left out.
std::vector<PhaseLock> locked_phases(const std::map<std::string, std::vector<cosim::Time>>& starts);

}  // namespace puckloop::tools
