#pragma once
// The registers of the e-RandB range-and-bearing board as its I2C master sees them (range-and-bearing fact
// sheet, section 2.1).

#include <cstdint>

namespace puckloop::control::rab {

inline constexpr std::uint16_t kAddress = 0x20;

// Read
inline constexpr std::uint8_t kPop = 0;       ///< 1 and the next message, or 0 if there is none
inline constexpr std::uint8_t kData1 = 1;     ///< data bits 15..8; kData1 + 1: bits 7..0
inline constexpr std::uint8_t kBearing = 3;   ///< signed, 1e-4 rad, high byte first
inline constexpr std::uint8_t kStrength = 5;  ///< unsigned, high byte first
inline constexpr std::uint8_t kPeak = 7;      ///< largest peak, high byte first
inline constexpr std::uint8_t kSensor = 9;    ///< the sensor that saw it, 0..11
inline constexpr std::uint8_t kData3 = 10;    ///< data bits 31..24; kData3 + 1: bits 23..16

// Write; 0..11: payload of that emitter
inline constexpr std::uint8_t kRange = 12;     ///< potentiometer: 0 farthest (about 1 m), 255 shortest
inline constexpr std::uint8_t kAux = 13;       ///< high part of the payload = value
inline constexpr std::uint8_t kSendAll = 14;   ///< low byte of the payload of all emitters; sends
inline constexpr std::uint8_t kSendEach = 15;  ///< sends what registers 0..11 hold, and forgets it
inline constexpr std::uint8_t kBaseline = 16;  ///< takes the light of this moment for darkness
inline constexpr std::uint8_t kCompute = 17;   ///< 0: the board computes range and bearing
inline constexpr std::uint8_t kAuxShift = 20;  ///< high part of the payload = high part * 256 + value
inline constexpr std::uint8_t kBits = 21;      ///< payload bits: 8, 16, 24 or 32

inline constexpr int kEmitters = 12;
inline constexpr int kQueue = 10;                 ///< messages the board holds
inline constexpr int kDefaultRange = 115;         ///< ARGoS's setting
inline constexpr double kBearingUnit = 1e-4;      ///< rad
inline constexpr double kChipSeconds = 98.09e-6;  ///< on the air

/// Time a frame of `bytes` payload bytes is on the air: 2.9, 4.5, 6.1 or 7.7 ms.
constexpr double frame_seconds(int bytes) {
    return kChipSeconds * 2 * (3 + 8 * bytes + 4);
}

}  // namespace puckloop::control::rab
