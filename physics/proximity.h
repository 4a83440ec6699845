#pragma once
// The eight reflective infra-red sensors: what ADC counts the robot's own emitters add. Sources: physics
// facts section 2, e-puck facts 5.1.
//
// Deviations: 1. rays are level, at the sensors' height; pitch and roll are ignored. 2. Emitter and receiver
// are one point. 3. Only diffuse reflection: a mirror looks like a wall of its reflectivity.

#include "physics/parameters.h"
#include "physics/sensor_view.h"

#include <array>
#include <vector>

namespace puckloop::physics {

/// Counts from a white wall straight ahead, `distance` metres from the sensor; never negative, 0 beyond
/// reach.
double proximity_response(const ProximityParameters& parameters, double distance);

class ProximityRing {
  public:
    explicit ProximityRing(const ProximityParameters& parameters);

    /// Noise-free reflected counts, 0..4095.
    std::array<double, kProximitySensors> sense(const SensorView& view) const;
    /// Do values change by themselves (warm-up)?
    bool varies_with_time() const {
        return parameters_.warmup_gain != 0.0 || parameters_.battery_gain != 0.0 ||
               parameters_.motor_sag != 0.0;
    }
    /// Nothing further than this from the axle's middle is seen.
    double horizon() const { return horizon_; }

  private:
    double reflected(const SensorView& view, std::size_t sensor, double cosine, double sine) const;

    ProximityParameters parameters_;
    std::array<std::vector<Ray>, kProximitySensors> rays_;  // in the robot's frame
    double horizon_ = 0.0;
};

}  // namespace puckloop::physics
