#pragma once
// The three ground sensors: floor grey to 10-bit counts. Sources: physics facts section 3, e-puck facts 5.2.
//
// Deviations: 1. the footprint is averaged over five points. 2. Outside the arena the floor goes on.

#include "physics/parameters.h"
#include "physics/sensor_view.h"

#include <array>

namespace puckloop::physics {

/// Grey (0 black .. 1 white) of the floor at a point; later patches lie on top.
double floor_grey(double base, std::span<const Patch> patches, double x, double y);

class GroundRow {
  public:
    GroundRow(const GroundParameters& parameters, double base_grey, std::span<const Patch> patches);

    /// Left, centre, right: noise-free counts, 0..saturation.
    std::array<double, kGroundSensors> sense(const RobotState& robot) const;

  private:
    GroundParameters parameters_;
    double base_grey_;
    std::span<const Patch> patches_;
};

}  // namespace puckloop::physics
