#include "selftest/emulate/wave_floor.h"

#include "physics/description/parameters.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace puckloop::gap::emulate {

namespace {

constexpr double kWaveStripe = 0.00025;                           // m
constexpr int kStripes = 800;                                     // on each side of x = 0
constexpr double kRadiansPerMetre = 2 * std::numbers::pi / 0.24;  // of the wave
constexpr double kMiddle = 0.5, kSwing = 0.4;                     // grey

double stripe(double index) {
    return kMiddle + kSwing * std::sin(kRadiansPerMetre * (index + 0.5) * kWaveStripe);
}

}  // namespace

std::string wave_floor() {
    std::string floor = "[arena]\nsize = [\"3 m\", \"2 m\"]\n";
    for (int k = -kStripes; k < kStripes; ++k)
        floor += fmt::format(
            "[[floor_patch]]\ncentre = [\"{} m\", \"0 m\"]\nsize = [\"{} m\", \"1.8 m\"]\ngrey = {}\n",
            (k + 0.5) * kWaveStripe, kWaveStripe, stripe(k));
    return floor;
}

double wave_grey(double x) {
    // The simulator looks at the middle and at four points around it, two of them as far along x.
    const double reach = physics::Parameters().ground.footprint / 2;
    const auto at = [](double place) { return stripe(std::floor(place / kWaveStripe)); };
    return (3 * at(x) + at(x + reach) + at(x - reach)) / 5;
}

double wave_slope(double x) {
    return kSwing * kRadiansPerMetre * std::cos(kRadiansPerMetre * x);
}

}  // namespace puckloop::gap::emulate
