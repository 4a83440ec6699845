#pragma once
// Figures of the I2C bus that its node, its faults and its log share.

#include "cosim/core/time.h"

#include <cstdint>

namespace puckloop::cosim {

inline constexpr Time kClocksOfByte = 9;     ///< eight bits and the acknowledgement
inline constexpr std::uint8_t kReadBit = 1;  ///< of the address byte

inline constexpr int kBitsOfByte = 8;
inline constexpr std::uint8_t kFirstBit = 0x80;  ///< on the wire
inline constexpr std::uint8_t kReleased = 0xFF;  ///< a byte that nobody drives

/// As reports state times on the bus.
inline double microseconds(Time time) {
    return static_cast<double>(time) / static_cast<double>(kMicrosecond);
}

}  // namespace puckloop::cosim
