#pragma once
// What a proximity reading gets on top of what is reflected: lamps' flicker, scatter, foreign pulses.
//
// Deviations: 1. all of it acts on the lit sample and is drawn anew each physics step, so that each sample of
// a firmware has its own; sensors sampled within the same step do not differ from their neighbours in time.
// 2. Scatter is Gaussian and white. 3. Each sensor sees a lamp's flicker in a phase of its own, drawn once a
// run: they look elsewhere and are sampled at other times.

#include "base/random.h"
#include "physics/description/parameters.h"
#include "physics/sensors/sensor_view.h"

#include <array>
#include <string>

namespace puckloop::physics {

class ProximityNoise {
  public:
    /// Streams are the robot's own; with neutral parameters nothing is drawn.
    ProximityNoise(const ProximityParameters& parameters, std::uint64_t seed, const std::string& robot);

    void set_parameters(const ProximityParameters& parameters) { parameters_ = parameters; }
    bool any() const { return flickers() || scatters() || hits(); }
    /// Once a physics step, to readings before they are cut to what can be read.
    void add(std::array<double, kProximitySensors>& counts, const Surroundings& now);

  private:
    bool flickers() const { return parameters_.flicker > 0.0; }
    bool scatters() const {
        return parameters_.motor_noise > 0.0 || parameters_.proportional_noise > 0.0 ||
               parameters_.ambient_noise > 0.0;
    }
    bool hits() const { return parameters_.interference_rate > 0.0; }

    ProximityParameters parameters_;
    RandomStream scatter_, pulses_;
    std::array<double, kProximitySensors> phase_{};  // rad, of the flicker
};

}  // namespace puckloop::physics
