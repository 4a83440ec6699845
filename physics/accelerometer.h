#pragma once
// The analogue three-axis accelerometer: acceleration and gravity as counts. Source: e-puck facts 5.4.
//
// Deviations: 1. it sits in the body's centre of mass. 2. A first-order low pass stands for its bandwidth.

#include "physics/dynamics.h"
#include "physics/parameters.h"

#include <array>

namespace puckloop::physics {

class Accelerometer {
  public:
    Accelerometer(const AccelerometerParameters& parameters, const SimulationParameters& world);

    /// Once a physics step. Counts for x (right), y (rear), z (up), 0..4095.
    std::array<double, 3> sense(const RobotState& robot);

  private:
    AccelerometerParameters parameters_;
    double one_g_;
    double share_;  // of a new value that passes the low pass in one step
    std::array<double, 3> gravity_;
    std::array<double, 3> last_velocity_{};
    std::array<double, 3> filtered_{};  // m/s2 forward, left, up
    bool first_ = true;
};

}  // namespace puckloop::physics
