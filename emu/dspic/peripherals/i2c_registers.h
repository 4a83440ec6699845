#pragma once
// Registers and bits of an I2C module, shared by its master and its slave. Offsets count from I2CxRCV.
// Source: dsPIC30F Family Reference Manual, section 21, and DS70286.

#include "emu/dspic/peripherals/surroundings.h"

namespace puckloop::dspic::i2c {

enum Offset : int { kRcv = 0, kTrn = 2, kBrg = 4, kCon = 6, kStat = 8, kAdd = 10, kMsk = 12 };

// I2CxCON
inline constexpr std::uint16_t kI2cen = bit(15);
inline constexpr std::uint16_t kSclrel = bit(12);
inline constexpr std::uint16_t kIpmien = bit(11);
inline constexpr std::uint16_t kA10m = bit(10);
inline constexpr std::uint16_t kGcen = bit(7);
inline constexpr std::uint16_t kStren = bit(6);
inline constexpr std::uint16_t kAcken = bit(4);
inline constexpr std::uint16_t kRcen = bit(3);
inline constexpr std::uint16_t kPen = bit(2);
inline constexpr std::uint16_t kRsen = bit(1);
inline constexpr std::uint16_t kSen = bit(0);
// I2CxSTAT
inline constexpr std::uint16_t kAckstat = bit(15);
inline constexpr std::uint16_t kTrstat = bit(14);
inline constexpr std::uint16_t kBcl = bit(10);
inline constexpr std::uint16_t kGcstat = bit(9);
inline constexpr std::uint16_t kIwcol = bit(7);
inline constexpr std::uint16_t kI2cov = bit(6);
inline constexpr std::uint16_t kDa = bit(5);
inline constexpr std::uint16_t kP = bit(4);
inline constexpr std::uint16_t kS = bit(3);
inline constexpr std::uint16_t kRw = bit(2);
inline constexpr std::uint16_t kRbf = bit(1);
inline constexpr std::uint16_t kTbf = bit(0);
inline constexpr std::uint16_t kClearable = kBcl | kIwcol | kI2cov;

}  // namespace puckloop::dspic::i2c
