#pragma once
// Results and flags of the arithmetic instructions, as the boolean formulas of the instruction set manual.
// `B` is a byte: std::uint8_t, or Lanes (fast/lanes.h), a byte of many turns of a loop at once. Carries and
// overflows are bytes 0 or 1.

#include "emu/avr/machine/state.h"

#include <cstdint>

namespace puckloop::avr {

/// A result and the flags that come with it.
template <class B>
struct Alu {
    B value;
    B flags;
};

constexpr std::uint8_t zero_flag(std::uint8_t value) {
    return value == 0 ? sreg::Z : 0;
}

/// N, Z, and S = N ^ V of a result with this overflow bit.
template <class B>
constexpr B sign_flags(const B& value, const B& overflow) {
    const B negative = static_cast<B>(value >> 7);
    return static_cast<B>(negative << 2 | overflow << 3 | (negative ^ overflow) << 4 | zero_flag(value));
}

template <class B>
constexpr Alu<B> add(const B& d, const B& r, const B& carry) {
    const B sum = static_cast<B>(d + r + carry);
    const B carries = static_cast<B>((d & r) | ((d | r) & ~sum));
    const B overflow = static_cast<B>(((d ^ sum) & (r ^ sum)) >> 7 & std::uint8_t{1});
    return {sum, static_cast<B>(sign_flags(sum, overflow) | (carries << 2 & sreg::H) | carries >> 7)};
}

template <class B>
constexpr Alu<B> subtract(const B& d, const B& r, const B& borrow) {
    const B rest = static_cast<B>(d - r - borrow);
    const B borrows = static_cast<B>((~d & r) | ((~d | r) & rest));
    const B overflow = static_cast<B>(((d ^ r) & (d ^ rest)) >> 7 & std::uint8_t{1});
    return {rest, static_cast<B>(sign_flags(rest, overflow) | (borrows << 2 & sreg::H) | borrows >> 7)};
}

/// SBC, CPC and SBCI leave Z only where it was set: the result of several bytes is zero if every byte is.
template <class B>
constexpr Alu<B> chained(const Alu<B>& result, const B& flags_before) {
    return {result.value,
            static_cast<B>(result.flags & (flags_before | static_cast<std::uint8_t>(~sreg::Z)))};
}

/// AND, OR, EOR and their like.
template <class B>
constexpr Alu<B> logic(const B& value) {
    return {value, sign_flags(value, static_cast<B>(std::uint8_t{0}))};
}

/// INC and DEC: they overflow to `edge`.
template <class B>
constexpr Alu<B> count(const B& value, std::uint8_t edge) {
    const B overflow = static_cast<B>(zero_flag(static_cast<B>(value ^ static_cast<B>(edge))) >> 1);
    return {value, sign_flags(value, overflow)};
}

/// Shifts to the right: `out` falls into C, V = N ^ C.
template <class B>
constexpr Alu<B> shift_right(const B& d, const B& from_above) {
    const B value = static_cast<B>(from_above | d >> 1);
    const B out = static_cast<B>(d & std::uint8_t{1});
    return {value, static_cast<B>(sign_flags(value, static_cast<B>(value >> 7 ^ out)) | out)};
}

inline constexpr std::uint8_t kSvnz = sreg::S | sreg::V | sreg::N | sreg::Z;
inline constexpr std::uint8_t kSvnzc = kSvnz | sreg::C;
inline constexpr std::uint8_t kHsvnzc = kSvnzc | sreg::H;

}  // namespace puckloop::avr
