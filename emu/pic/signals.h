#pragma once
// The named signals of the e-puck main board. Ids are indexes into signals(); the same list serves the
// bench's
// --stimulus and --list-signals, and the `world` port of the board's node.

#include "cosim/core/signal_info.h"

#include <cstdint>
#include <span>

namespace puckloop::pic {

using SignalId = std::uint16_t;

// Inputs.
inline constexpr SignalId kProximity = 0;        ///< 8: counts by which reflected light drops AN8+i when lit
inline constexpr SignalId kAmbient = 8;          ///< 8: counts at AN8+i without own emitter; dark ~4000
inline constexpr SignalId kMicrophone = 16;      ///< 3: counts at AN2+i
inline constexpr SignalId kAcceleration = 19;    ///< 3: counts at AN5+i (x right, y rear, z up)
inline constexpr SignalId kAdc = 22;             ///< 16: counts at ANi, whatever stands there
inline constexpr SignalId kBatteryVoltage = 38;  ///< V; below 3.4 V the battery-low pin falls
inline constexpr SignalId kBatteryLow = 39;      ///< 1 = low (pin RF1 at 0)
inline constexpr SignalId kSelector = 40;        ///< 0..15
inline constexpr SignalId kRemote = 41;          ///< level of the infra-red remote receiver, idle 1
// Outputs.
inline constexpr SignalId kWheelLeft = 42;  ///< cumulative motor steps, + is forward
inline constexpr SignalId kWheelRight = 43;
inline constexpr SignalId kLed = 44;  ///< 8: ring LEDs, 0 = front, then clockwise
inline constexpr SignalId kLedFront = 52;
inline constexpr SignalId kLedBody = 53;
inline constexpr SignalId kPulse = 54;    ///< 4: infra-red emitters of the sensors i and i+4
inline constexpr SignalId kAudioOn = 58;  ///< codec and amplifier out of reset
inline constexpr SignalId kCameraReset = 59;
// Inputs that came later; ids of the others stay what they are in recorded runs.
inline constexpr SignalId kMicrophoneLevel = 60;  ///< 3: volume of the sound at microphone i, counts
inline constexpr SignalId kMicrophoneLost = 63;   ///< share of microphone samples that hold the one before
inline constexpr SignalId kResetButton = 64;    ///< 1 = the reset button is pressed (MCLR), which resets once
inline constexpr SignalId kInfraredLight = 65;  ///< 8: counts by which others' infra-red light drops AN8+i
inline constexpr SignalId kSpeaker = 73;        ///< output: what drives the speaker, -1..1
inline constexpr SignalId kSound = 74;          ///< 3: waveform at microphone i, counts
inline constexpr SignalId kLineIn = 77;         ///< at the codec's line input, -1..1
inline constexpr SignalId kSignalCount = 78;

inline constexpr int kProximityCount = 8;
inline constexpr int kMicrophoneCount = 3;
inline constexpr int kAdcCount = 16;
inline constexpr int kLedCount = 8;
inline constexpr int kPulseCount = 4;

/// kSignalCount entries in the order of their ids.
std::span<const cosim::SignalInfo> signals();

}  // namespace puckloop::pic
