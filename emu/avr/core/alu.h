#pragma once
// Results and flags of the arithmetic instructions, as the boolean formulas of the instruction set manual.

#include "emu/avr/core/state.h"

#include <cstdint>

namespace puckloop::avr {

/// A result and the flags that come with it.
struct Alu {
    std::uint8_t value = 0;
    std::uint8_t flags = 0;
};

/// N, Z, and S = N ^ V of a result with this overflow bit.
constexpr std::uint8_t sign_flags(std::uint8_t value, bool overflow) {
    const bool negative = value >> 7;
    return static_cast<std::uint8_t>((negative != overflow ? sreg::S : 0) | (overflow ? sreg::V : 0) |
                                     (negative ? sreg::N : 0) | (value == 0 ? sreg::Z : 0));
}

constexpr Alu add(std::uint8_t d, std::uint8_t r, bool carry) {
    const auto sum = static_cast<std::uint8_t>(d + r + carry);
    const int carries = (d & r) | ((d | r) & ~sum);
    const bool overflow = ((d ^ sum) & (r ^ sum)) >> 7 & 1;
    return {sum, static_cast<std::uint8_t>(sign_flags(sum, overflow) | (carries & 8 ? sreg::H : 0) |
                                           (carries & 0x80 ? sreg::C : 0))};
}

constexpr Alu subtract(std::uint8_t d, std::uint8_t r, bool borrow) {
    const auto rest = static_cast<std::uint8_t>(d - r - borrow);
    const int borrows = (~d & r) | ((~d | r) & rest);
    const bool overflow = ((d ^ r) & (d ^ rest)) >> 7 & 1;
    return {rest, static_cast<std::uint8_t>(sign_flags(rest, overflow) | (borrows & 8 ? sreg::H : 0) |
                                            (borrows & 0x80 ? sreg::C : 0))};
}

/// Of the shifts to the right: `out` falls into C, V = N ^ C.
constexpr std::uint8_t shift_flags(std::uint8_t value, bool out) {
    const bool negative = value >> 7;
    return static_cast<std::uint8_t>(sign_flags(value, negative != out) | (out ? sreg::C : 0));
}

inline constexpr std::uint8_t kSvnz = sreg::S | sreg::V | sreg::N | sreg::Z;
inline constexpr std::uint8_t kSvnzc = kSvnz | sreg::C;
inline constexpr std::uint8_t kHsvnzc = kSvnzc | sreg::H;

}  // namespace puckloop::avr
