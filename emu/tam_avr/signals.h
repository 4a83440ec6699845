#pragma once
// The named signals of the TAM's board. Ids are indexes into signals(); the same list serves the bench's
// --stimulus and --list-signals, and the `world` port of the board's node. "left" and "right" are the
// schematic's; the robot enters by the front.

#include "cosim/core/signal_info.h"

#include <cstdint>
#include <span>

namespace puckloop::tam {

using SignalId = std::uint16_t;

/// The two light barriers, front first.
inline constexpr int kBarriers = 2;
/// Outputs of the LED driver.
inline constexpr int kLeds = 16;

// Inputs.
inline constexpr SignalId kBarrier = 0;         ///< 2: part of the beam that is interrupted, 0..1
inline constexpr SignalId kAmbient = 2;         ///< 2: volts that daylight alone makes at the sensor
inline constexpr SignalId kBattery = 4;         ///< volts
inline constexpr SignalId kProximitySense = 5;  ///< 1: the infra-red comparator sees light
inline constexpr SignalId kNetworkSwitch = 6;   ///< 2: XBEE_NET_0 and XBEE_NET_1, 1 = open
// Outputs.
inline constexpr SignalId kProximityEmit = 8;  ///< 1: infra-red LED of the transceiver on
inline constexpr SignalId kNetworkLed = 9;
inline constexpr SignalId kPowerClear = 10;  ///< 1: the firmware switches the booth off
inline constexpr SignalId kXBeeReset = 11;   ///< 1: the radio module is held in reset
inline constexpr SignalId kXBeeRts = 12;     ///< level at PC2
inline constexpr SignalId kXBeeWake = 13;    ///< level at PD4
inline constexpr SignalId kLed = 14;         ///< 16: share of the time that the LED is on
inline constexpr SignalId kPower = 30;       ///< 1: the board has supply
// Input.
inline constexpr SignalId kVdd = 31;  ///< V that the supply has at most, as a load pulls it down
inline constexpr SignalId kSignalCount = 32;

/// Outputs of the LED driver that light the barriers.
inline constexpr int kInfraredRight = 0, kInfraredLeft = 10;

/// kSignalCount entries.
std::span<const cosim::SignalInfo> signals();

}  // namespace puckloop::tam
