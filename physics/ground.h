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

/// What else a reading depends on.
struct GroundMoment {
    double seconds = 0.0;
    double acceleration = 0.0;  ///< m/s2 forward, over the last 0.1 s
    bool no_floor = false;      ///< the robot is held in the air: nothing comes back
};

class GroundRow {
  public:
    GroundRow(const GroundParameters& parameters, double base_grey, std::span<const Patch> patches);

    /// The floor changed; `patches` must outlive it.
    void set_floor(double base_grey, std::span<const Patch> patches) {
        base_grey_ = base_grey;
        patches_ = patches;
    }
    /// Mean grey under each sensor: left, centre, right.
    std::array<double, kGroundSensors> greys(const RobotState& robot) const;
    /// Noise-free counts over such greys, 0..saturation; of `robot` pitch and roll count.
    std::array<double, kGroundSensors> counts(const std::array<double, kGroundSensors>& greys,
                                              const RobotState& robot, const GroundMoment& now) const;

  private:
    GroundParameters parameters_;
    double base_grey_;
    std::span<const Patch> patches_;
};

}  // namespace puckloop::physics
