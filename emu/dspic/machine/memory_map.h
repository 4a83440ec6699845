#pragma once
// The data and program space that every part of the family shares; sizes that differ are in DeviceInfo.

#include <cstdint>

namespace puckloop::dspic {

/// W0 to W15 are data addresses 0 to 0x1F.
inline constexpr std::uint16_t kWEnd = 0x0020;
/// First data address behind the special-function registers, where RAM begins.
inline constexpr std::uint16_t kRamStart = 0x0800;
/// First data address of the program-space window.
inline constexpr std::uint16_t kPsvStart = 0x8000;
/// Bits of a program address: it wraps at the 23 bits of the program counter, and bit 0 does not exist.
inline constexpr std::uint32_t kProgramSpace = 0x7FFFFE;

}  // namespace puckloop::dspic
