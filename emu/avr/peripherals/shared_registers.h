#pragma once
// Registers and bits that several peripherals look at, by their data-sheet names (ATmega1284P, 8272). What
// one peripheral alone uses is in its own file.

#include "emu/avr/peripherals/surroundings.h"

#include <cstdint>

namespace puckloop::avr {

inline constexpr std::uint16_t kMcusr = 0x54, kMcucr = 0x55, kPrr0 = 0x64, kOsccal = 0x66;
inline constexpr std::uint16_t kAdcsra = 0x7A, kAdcsrb = 0x7B, kAdmux = 0x7C;

inline constexpr std::uint8_t kWdrf = bit(3);  // MCUSR
inline constexpr std::uint8_t kPud = bit(4);   // MCUCR
inline constexpr std::uint8_t kAden = bit(7);  // ADCSRA
inline constexpr std::uint8_t kAs2 = bit(5);   // ASSR

inline constexpr std::uint8_t kHighest = bit(7), kLowest = bit(0);  // of a byte that is shifted
inline constexpr double kBandgap = 1.1;                             // V

}  // namespace puckloop::avr
