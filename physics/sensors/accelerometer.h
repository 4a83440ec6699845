#pragma once
// The three-axis accelerometer: acceleration and gravity, as the counts of the analogue one, and in g for an
// LSM330, which stands at the same place. Source: e-puck facts 5.4.
//
// Deviations: 1. it sits in the body's centre of mass. 2. A first-order low pass represents its bandwidth.
// 3. Vibration is white noise behind the low pass, drawn anew each physics step, so that each sample of a
// firmware has its own.

#include "base/random.h"
#include "physics/description/parameters.h"
#include "physics/sensors/sensor_view.h"

#include <array>
#include <string>

namespace puckloop::physics {

class Accelerometer {
  public:
    /// `seed` and the robot's name make its streams, which change nothing with neutral parameters.
    Accelerometer(const AccelerometerParameters& parameters, const SimulationParameters& world,
                  std::uint64_t seed, const std::string& robot);

    void set_parameters(const AccelerometerParameters& parameters);
    /// Once a physics step. Counts for x (right), y (rear), z (up), 0..4095.
    std::array<double, 3> sense(const RobotState& robot, const Surroundings& now);
    /// What it sensed last, g forward, left, up, whatever the converter's range: the counts without their
    /// zero, over the gain.
    const std::array<double, 3>& in_g() const { return in_g_; }

  private:
    AccelerometerParameters parameters_{};
    RandomStream vibration_;
    double one_g_;
    double share_ = 1.0;  // of a new value that passes the low pass in one step
    double turn_cosine_ = 1.0, turn_sine_ = 0.0;
    std::array<double, 3> zero_{};  // counts, this session's
    std::array<double, 3> gravity_;
    std::array<double, 3> last_velocity_{};
    std::array<double, 3> filtered_{};  // m/s2 forward, left, up
    std::array<double, 3> in_g_{};
    bool first_ = true;
};

}  // namespace puckloop::physics
