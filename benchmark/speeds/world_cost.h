#pragma once
// What a millisecond of the physical world costs, part by part, without boards: robots that wander are driven
// by step counts as their motors' firmware would make them.

#include "physics/dynamics/step_observer.h"

#include <array>

namespace puckloop::tools {

struct WorldLoad {
    int robots = 10;
    int lamps = 0;       ///< in a ring around the middle
    bool moving = true;  ///< false: they stand
    double simulated_s = 2.0;
    double settle_s = 0.5;  ///< before the measurement
};

/// Processor time of this thread, microseconds for each robot and step.
struct WorldCost {
    std::array<double, physics::kStepParts> part_us{};
    double messages = 0.0;  ///< published for each robot and step
    double total_us() const;
};

WorldCost measure_world(const WorldLoad& load);

}  // namespace puckloop::tools
