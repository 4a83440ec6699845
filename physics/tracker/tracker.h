#pragma once
// An overhead tracker: cameras above the arena that read a marker on each robot. What it is wrong by:
// noise of places and headings, robots that it loses for a while, two markers that it takes for each other.

#include "base/random.h"
#include "physics/description/description.h"
#include "physics/dynamics/dynamics.h"
#include "physics/tracker/tracker_spec.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace puckloop::physics {

/// A robot as the tracker has it.
struct TrackedRobot {
    std::size_t robot = 0;                   ///< whom it takes it for: number in the world
    double x = 0.0, y = 0.0, heading = 0.0;  ///< m, rad in (-pi, pi]
};

struct TrackerFrame {
    std::uint64_t number = 0;            ///< from 0
    std::uint64_t step = 0;              ///< ms: when the cameras saw it
    std::uint64_t arrives = 0;           ///< ms: when whoever listens has it
    std::vector<TrackedRobot> robots{};  ///< those that it sees, by number
};

class Tracker {
  public:
    /// `corners`: of the arena, m. `seed`: of the run.
    Tracker(const TrackerSpec& spec, std::vector<Point> corners, std::uint64_t seed, std::size_t robots);

    /// A frame is due in step `step` (ms); asked in each step once.
    bool due(std::uint64_t step) const;
    TrackerFrame see(std::uint64_t step, std::span<const RobotState> robots);

  private:
    void swap_labels(std::span<const RobotState> robots);
    bool lost(std::size_t robot, const RobotState& state);
    bool at_edge(const RobotState& state) const;

    TrackerSpec spec_;
    std::vector<Point> corners_;
    RandomStream noise_, losses_, swaps_;
    std::vector<std::size_t> label_;  // whom it takes each robot for
    std::vector<bool> lost_;          // by robot
    std::uint64_t frames_ = 0;
};

}  // namespace puckloop::physics
