#pragma once
// The eight reflective infra-red sensors: what ADC counts the robot's own emitters add. Sources: physics
// facts section 2, e-puck facts 5.1.
//
// Deviations: 1. rays are level, at the sensors' height; pitch and roll are ignored. 2. Emitter and receiver
// are one point. 3. Only diffuse reflection: a mirror looks like a wall of its reflectivity.

#include "physics/description/parameters.h"
#include "physics/sensors/sensor_view.h"

#include <array>
#include <vector>

namespace puckloop::physics {

/// Counts from a white wall straight ahead, `distance` metres from the sensor; never negative, 0 beyond
/// reach.
double proximity_response(const ProximityParameters& parameters, double distance);

/// What a sensor's middle ray meets.
struct FacedSurface {
    double distance = 0.0;  ///< m; the reach where it meets nothing
    double angle = 0.0;     ///< rad between ray and normal
};

class ProximityRing {
  public:
    explicit ProximityRing(const ProximityParameters& parameters);

    /// What each sensor sees of its own light, by the response curve alone.
    std::array<double, kProximitySensors> reflected(const SensorView& view) const;
    std::array<FacedSurface, kProximitySensors> faced(const SensorView& view) const;
    /// What the readings become of it: crosstalk, gains, offsets, sag. Neither noise nor a converter's range.
    std::array<double, kProximitySensors> answer(const std::array<double, kProximitySensors>& reflected,
                                                 const Surroundings& now) const;
    /// Counts as they can be read: 0..4095, nothing in the dead zone.
    std::array<double, kProximitySensors> readable(std::array<double, kProximitySensors> counts) const;
    /// Does the answer change by itself (warm-up, battery, motors)?
    bool varies_with_time() const {
        return parameters_.warmup_gain != 0.0 || parameters_.battery_gain != 0.0 ||
               parameters_.motor_sag != 0.0;
    }
    /// Nothing further than this from the axle's middle is seen.
    double horizon() const { return horizon_; }

  private:
    double seen_by(const SensorView& view, std::size_t sensor, double cosine, double sine) const;

    ProximityParameters parameters_;
    std::array<std::vector<Ray>, kProximitySensors> rays_;  // in the robot's frame
    double horizon_ = 0.0;
};

}  // namespace puckloop::physics
