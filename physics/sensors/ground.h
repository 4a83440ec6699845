#pragma once
// The three ground sensors: floor grey to 10-bit counts. Sources: physics facts section 3, e-puck facts 5.2.
//
// Deviations: 1. the footprint is averaged over five points. 2. Outside the arena the floor goes on. 3.
// Infra-red sees a coloured floor as grey of the same luminance.

#include "physics/description/parameters.h"
#include "physics/sensors/pheromone.h"
#include "physics/sensors/sensor_view.h"

#include <array>
#include <span>
#include <vector>

namespace puckloop::physics {

/// What else a reading depends on.
struct GroundMoment {
    double seconds = 0.0;
    double acceleration = 0.0;  ///< m/s2 forward, over the last 0.1 s
    bool no_floor = false;      ///< the robot is held in the air: nothing comes back
};

class GroundRow {
  public:
    GroundRow(const GroundParameters& parameters, double base_grey, std::span<const Patch> patches);

    /// The floor changed.
    void set_floor(double base_grey, std::span<const Patch> patches);
    /// Mean grey under each sensor: left, centre, right.
    std::array<double, kGroundSensors> greys(const RobotState& robot) const;
    /// The same with trails on it.
    std::array<double, kGroundSensors> greys(const RobotState& robot,
                                             std::span<const PheromoneField> trails) const;
    /// Noise-free counts over such greys, 0..saturation; of `robot` pitch and roll count.
    std::array<double, kGroundSensors> counts(const std::array<double, kGroundSensors>& greys,
                                              const RobotState& robot, const GroundMoment& now) const;

  private:
    /// A patch with what is asked for at each of its points.
    struct Cover {
        Patch patch;
        double cosine = 1.0, sine = 0.0;
        double radius = 0.0;  // of a circle around it
        bool at(double x, double y) const;
        double grey(double x, double y) const;
    };
    bool near_a_patch(double x, double y) const;
    Point spot(const RobotState& robot, double cosine, double sine, std::size_t sensor) const;
    double grey_at(double x, double y) const;

    GroundParameters parameters_;
    double reach_;  // from the axle's middle to the furthest spot
    double base_grey_ = 1.0;
    double base_mean_ = 1.0;  // what averaging base_grey_ gives
    std::vector<Cover> covers_;
};

}  // namespace puckloop::physics
