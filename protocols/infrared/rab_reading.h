#pragma once
// What the range-and-bearing board makes of a frame's twelve peaks: bearing, range register, strongest peak,
// in single precision as its firmware computes them. Source: the range-and-bearing facts, 4.3.

#include <array>
#include <cstdint>

namespace puckloop::protocols {

inline constexpr int kRabSensors = 12;

struct RabReading {
    std::int16_t bearing = 0;  ///< 1e-4 rad, truncated; as registers 3 and 4
    std::uint16_t range = 0;   ///< combined strength, bigger is nearer; registers 5 and 6
    std::uint16_t peak = 0;    ///< largest peak; registers 7 and 8
    std::uint8_t sensor = 0;   ///< where, 0..11; register 9
};

/// `peaks`: counts above the baseline, 0..4095; 0 for a sensor whose frame did not pass the check.
RabReading rab_reading(const std::array<int, kRabSensors>& peaks);

/// Distance in cm from a strength by the published formula; `gain` 1 in simulators, 0.0867438559 the robots'
/// default.
double rab_distance_cm(double strength, double gain = 1.0);

}  // namespace puckloop::protocols
