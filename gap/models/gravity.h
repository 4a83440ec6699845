#pragma once
// Acceleration of free fall, m/s2.

namespace puckloop::gap {

inline constexpr double kGravity = 9.81;

}  // namespace puckloop::gap
