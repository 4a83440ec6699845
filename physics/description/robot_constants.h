#pragma once
// The robot as its drawings give it, where a number is needed before there are parameters: their defaults
// (parameter_table.cpp has the sources), the units that some of them are given in, the library's sampling.

#include <numbers>

namespace puckloop::physics {

inline constexpr double kBodyRadius = 0.035;    ///< m
inline constexpr double kWheelRadius = 0.0205;  ///< m
inline constexpr double kAxleLength = 0.053;    ///< m, contact to contact
inline constexpr double kStepsPerTurn = 1000;   ///< of a wheel
inline constexpr double kMetresPerStep = 2 * std::numbers::pi * kWheelRadius / kStepsPerTurn;

inline constexpr double kSpeedUnit = 1000.0;      ///< steps/s at which vibration and motor noise are given
inline constexpr double kProximityRate = 63.015;  ///< Hz: samples of each sensor (e-puck facts 5.1)

}  // namespace puckloop::physics
