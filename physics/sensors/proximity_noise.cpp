#include "physics/sensors/proximity_noise.h"

#include "physics/description/robot_constants.h"

#include <cmath>
#include <numbers>

namespace puckloop::physics {

namespace {

constexpr double kPulseSpread = 0.3;  // of a foreign pulse's counts, share

RandomStream stream(std::uint64_t seed, const std::string& robot, const char* use) {
    return {seed, "physics/" + robot + "/" + use};
}

}  // namespace

ProximityNoise::ProximityNoise(const ProximityParameters& parameters, std::uint64_t seed,
                               const std::string& robot)
    : parameters_(parameters),
      scatter_(stream(seed, robot, "proximity_scatter")),
      pulses_(stream(seed, robot, "proximity_pulses")) {
    RandomStream phases = stream(seed, robot, "proximity_flicker");
    for (double& phase : phase_)
        phase = 2 * std::numbers::pi * phases.uniform();
}

void ProximityNoise::add(std::array<double, kProximitySensors>& counts, const Surroundings& now) {
    const auto& p = parameters_;
    const double swing = 2 * std::numbers::pi * p.flicker_frequency * now.seconds;
    const double growth = 1.0 + p.motor_noise * now.motor_speed / kSpeedUnit;
    const double common = p.still_noise * p.still_noise * (growth * growth - 1.0) +
                          p.ambient_noise * p.ambient_noise * now.ambient;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        double more = 0.0;
        if (flickers()) more += p.flicker * now.ambient * std::sin(swing + phase_[i]);
        if (scatters())
            more += std::hypot(std::sqrt(common), p.proportional_noise * counts[i]) * scatter_.normal();
        if (hits() && pulses_.uniform() < p.interference_rate * p.interference_share[i]) {
            const double size = p.interference_size * (1.0 + kPulseSpread * pulses_.normal());
            more += pulses_.uniform() < 0.5 ? size : -size;
        }
        counts[i] += more;
    }
}

}  // namespace puckloop::physics
