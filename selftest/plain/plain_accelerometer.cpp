#include "selftest/plain/plain_accelerometer.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap::selftest {

namespace {
constexpr double kZero = 2048, kOneG = 800, kGravity = 9.81, kFullScale = 4095;
constexpr double kHoldSeconds = 2.0;
constexpr double kWarmSeconds = 200.0;
}  // namespace

std::array<double, kAxes> feel(const AccelerometerKnobs& k, const Attitude& a) {
    // Specific force along the robot's own axes, in g, to first order in the tilt.
    const double ahead = a.forward / kGravity + std::sin(a.pitch);
    const double aside = a.left / kGravity + std::sin(a.roll);
    const double up = std::cos(a.pitch) * std::cos(a.roll);
    const double c = std::cos(k.turned), s = std::sin(k.turned);
    const std::array<double, kAxes> felt{-(c * aside - s * ahead), -(c * ahead + s * aside), up};
    std::array<double, kAxes> counts{};
    for (std::size_t i = 0; i < kAxes; ++i) {
        const double zero = kZero + k.bias[i] + (a.session > 1 ? k.session_jump : 0.0);
        double value = zero + kOneG * k.scale[i] * felt[i] + k.warm * (1.0 - std::exp(-a.t / kWarmSeconds));
        if (i == 0 && a.turning > 0.0) value += k.spin_pull;
        if (a.since_stop < kHoldSeconds) value += k.hold;
        if (a.steps != 0.0) value *= 1.0 - k.sag;
        counts[i] = std::clamp(value, 0.0, kFullScale);
    }
    return counts;
}

}  // namespace puckloop::gap::selftest
