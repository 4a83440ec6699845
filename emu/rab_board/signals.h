#pragma once
// The named signals of the range-and-bearing board. Ids are indexes into signals(); the same list serves the
// bench's --stimulus and --list-signals, and the `ir` and `world` ports of the board's node. Emitters,
// demodulators and peak detectors carry hardware numbers 1..12; id + 0 is number 1 (index 0 in the firmware).

#include "cosim/core/signal_info.h"

#include <cstdint>
#include <span>

namespace puckloop::rab {

using SignalId = std::uint16_t;

inline constexpr int kSensorCount = 12;  ///< as many emitters, demodulators and peak detectors

// Inputs.
inline constexpr SignalId kDemodulator = 0;  ///< 12: 1 = carrier seen, the pin is then low
inline constexpr SignalId kPeak = 12;        ///< 12: A/D counts at the peak detector's input
// Outputs.
inline constexpr SignalId kEmitter = 24;    ///< 12: 1 = carrier on (gate, supply and OC1 all on)
inline constexpr SignalId kCarrier = 36;    ///< Hz of OC1, 0 = off
inline constexpr SignalId kPower = 37;      ///< the potentiometer's byte, 0 = strongest
inline constexpr SignalId kLed = 38;        ///< level at the LED's pin
inline constexpr SignalId kPeakReset = 39;  ///< 12: 1 = detector is being discharged; not on the `ir` port
// Inputs.
inline constexpr SignalId kBattery = 51;  ///< V of the robot's battery, behind which the regulator is
inline constexpr SignalId kVdd = 52;      ///< V that the supply has at most, as a load pulls it down
inline constexpr SignalId kSignalCount = 53;

/// What the potentiometer's byte is until the first one is latched: mid scale, as such parts power up (an
/// inference; the firmware writes 0 before anything is emitted).
inline constexpr int kPowerAtPowerOn = 128;

/// kSignalCount entries.
std::span<const cosim::SignalInfo> signals();

}  // namespace puckloop::rab
