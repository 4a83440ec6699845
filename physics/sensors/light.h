#pragma once
// Ambient light at the eight phototransistors: counts fall with light. Sources: physics facts section 2
// (ambient light), e-puck facts 5.1.
//
// Deviations: 1. shadows are sharp and bodies opaque; nothing reflects lamp light. 2. Room light has no
// direction and no shadow.

#include "physics/description/parameters.h"
#include "physics/sensors/sensor_view.h"

#include <array>
#include <vector>

namespace puckloop::physics {

class LightRing {
  public:
    /// Positions and directions are the proximity sensors'.
    LightRing(const LightParameters& parameters, const ProximityParameters& places, double ambient_level,
              std::span<const Lamp> lamps);

    /// Noise-free ambient counts, 0..4095.
    std::array<double, kProximitySensors> sense(const SensorView& view);
    /// The room changed; `lamps` must outlive it.
    void set_room(double ambient_level, std::span<const Lamp> lamps) {
        ambient_level_ = ambient_level;
        lamps_ = lamps;
    }
    bool varies_with_time() const { return parameters_.flicker > 0.0; }

  private:
    double from_lamp(const Lamp& lamp, const Ray& sensor, std::span<const Shape* const> between) const;
    bool reaches(const Lamp& lamp, const RobotState& robot) const;
    void look_between(const SensorView& view, const Lamp& lamp);

    LightParameters parameters_;
    double height_;
    double ambient_level_;
    std::span<const Lamp> lamps_;
    std::array<Ray, kProximitySensors> sensors_;  // in the robot's frame
    double ring_ = 0.0;                           // the furthest of them from the axle's middle
    std::vector<const Shape*> between_;           // scratch: what may stand between a lamp and the sensors
};

}  // namespace puckloop::physics
