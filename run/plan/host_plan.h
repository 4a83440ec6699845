#pragma once
// On which host of a run each node lives: what is close together stays together, so that a robot's
// boards, and robots in each other's light, are on one.

#include "run/description/run_setup.h"

#include <span>
#include <vector>

namespace puckloop::tools {

/// A robot or a booth.
struct StandingUnit {
    double x = 0.0, y = 0.0;  ///< m, at the start
    double work = 1.0;        ///< its share of the run's
};

/// The part of each unit, from 0 on, below `parts` (at least 1). Parts are cut from each other where the
/// widest gap is that leaves about as much work on both sides.
std::vector<unsigned> parts_of(std::span<const StandingUnit> units, unsigned parts);

/// Robots with all their nodes, and booths, go to hosts 1 to `hosts`; the world, media and whatever belongs
/// to no one of them stay with the conductor, and everything does for want of hosts.
void plan_hosts(RunSetup& setup, unsigned hosts);

}  // namespace puckloop::tools
