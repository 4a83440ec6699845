#pragma once
// Registers and bits of an I2C module, shared by its master and its slave. Offsets count from I2CxRCV.
// Source: dsPIC30F Family Reference Manual, section 21, and DS70286.

#include "emu/dspic/devices/register_bits.h"
#include "emu/dspic/peripherals/surroundings.h"

namespace puckloop::dspic::i2c {

enum Offset : int { kRcv = 0, kTrn = 2, kBrg = 4, kCon = 6, kStat = 8, kAdd = 10, kMsk = 12 };

inline constexpr RegisterBits kI2CxCON{"I2C*CON"};
inline constexpr RegisterBits kI2CxSTAT{"I2C*STAT"};
inline constexpr std::uint16_t kClearable = kI2CxSTAT["BCL"] | kI2CxSTAT["IWCOL"] | kI2CxSTAT["I2COV"];

}  // namespace puckloop::dspic::i2c
