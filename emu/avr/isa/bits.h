#pragma once
// One line of the instruction table as bits: what a pattern string fixes and where its fields lie. Everything
// here runs at compile time.

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string_view>

namespace puckloop::avr {

/// "0000 11rd dddd rrrr" without its blanks, bit 15 first.
class BitPattern {
  public:
    constexpr BitPattern() = default;
    constexpr explicit BitPattern(std::string_view text) {
        std::size_t place = 0;
        for (const char c : text) {
            if (c == ' ') continue;
            if (place == letters_.size()) throw std::logic_error("a pattern of more than 16 bits");
            letters_[place++] = c;
            mask_ = static_cast<std::uint16_t>(mask_ << 1 | (c == '0' || c == '1'));
            value_ = static_cast<std::uint16_t>(value_ << 1 | (c == '1'));
        }
        if (place != letters_.size()) throw std::logic_error("a pattern of fewer than 16 bits");
    }

    constexpr std::uint16_t mask() const { return mask_; }    ///< bits that the pattern fixes
    constexpr std::uint16_t value() const { return value_; }  ///< and their values
    constexpr bool matches(std::uint16_t word) const { return (word & mask_) == value_; }
    /// True if some word matches both.
    constexpr bool overlaps(const BitPattern& other) const {
        return ((value_ ^ other.value_) & mask_ & other.mask_) == 0;
    }

    /// Number of bits under `letter`.
    constexpr int width(char letter) const {
        int bits = 0;
        for (const char c : letters_)
            bits += c == letter;
        return bits;
    }
    /// The bits of `word` under `letter`, most significant first; 0 if there are none.
    constexpr std::uint32_t field(char letter, std::uint16_t word) const {
        std::uint32_t number = 0;
        for (std::size_t i = 0; i < letters_.size(); ++i)
            if (letters_[i] == letter) number = number << 1 | (word >> (15 - i) & 1u);
        return number;
    }
    /// The low bits of `number` in the places of `letter`: the inverse of field().
    constexpr std::uint16_t place(char letter, std::uint32_t number) const {
        std::uint32_t word = 0;
        for (std::size_t i = letters_.size(); i-- > 0;) {
            if (letters_[i] != letter) continue;
            word |= (number & 1u) << (15 - i);
            number >>= 1;
        }
        return static_cast<std::uint16_t>(word);
    }

  private:
    std::array<char, 16> letters_{};
    std::uint16_t mask_ = 0;
    std::uint16_t value_ = 0;
};

}  // namespace puckloop::avr
