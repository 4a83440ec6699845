#pragma once
// What a domain (words.h) makes of operations on values if it can only carry them out on numbers: it asks for
// those by its word(), and fails there where it does not know them.

#include "emu/dspic/machine/execute/shape.h"

namespace puckloop::dspic {

template <class Domain>
class NumberOperations {
  public:
    /// Yes or no.
    using Bit = bool;
    /// 32 bits.
    using Product = std::uint32_t;

    template <class V>
    V conjunction(const V& a, const V& b) {
        return Domain::value(number(a) & number(b));
    }
    template <class V>
    V disjunction(const V& a, const V& b) {
        return Domain::value(number(a) | number(b));
    }
    template <class V>
    V exclusive(const V& a, const V& b) {
        return Domain::value(number(a) ^ number(b));
    }
    // Shifts of words, by up to 31 bits.
    template <class V>
    V left(const V& a, const V& count) {
        return Domain::value(number(a) << number(count) & 0xFFFF);
    }
    template <class V>
    V right(const V& a, const V& count) {
        return Domain::value(number(a) >> number(count));
    }
    template <class V>
    V signed_right(const V& a, const V& count) {
        return Domain::value(
            static_cast<std::uint32_t>(static_cast<std::int16_t>(number(a)) >> number(count)) & 0xFFFF);
    }
    /// By one to the left; `in` comes in from below. The bit above the operand's
    /// size is still there.
    template <class V>
    V doubled(bool, const V& a, bool in) {
        return Domain::value(number(a) << 1 | (in ? 1u : 0u));
    }
    /// By one to the right; `in` comes in from above.
    template <class V>
    V halved(bool byte, const V& a, bool in) {
        return Domain::value(number(a) >> 1 | (in ? top(byte) : 0u));
    }
    /// A byte to a word.
    template <class V>
    V sign_extended(const V& a) {
        const std::uint32_t byte = number(a);
        return Domain::value(byte & 0x80 ? byte | 0xFF00 : byte);
    }
    /// The bytes of a word, or the nibbles of its low byte.
    template <class V>
    V swapped(bool byte, const V& a) {
        const std::uint32_t w = number(a);
        return Domain::value(byte ? (w << 4 & 0xF0) | (w >> 4 & 0x0F) : (w << 8 | w >> 8) & 0xFFFF);
    }
    /// One bit of a word replaced.
    template <class V>
    V with_bit(const V& a, const V& place, bool bit) {
        const std::uint32_t mask = 1u << number(place);
        return Domain::value(bit ? number(a) | mask : number(a) & ~mask);
    }

    /// Whether any of the bits is set.
    template <class V>
    bool bit(const V& a, std::uint32_t mask) {
        return (number(a) & mask) != 0;
    }
    template <class V>
    bool equal(bool, const V& a, const V& b) {
        return number(a) == number(b);
    }
    /// As signed bytes or words.
    template <class V>
    bool less(bool byte, const V& a, const V& b) {
        const std::uint32_t flip = top(byte);
        return (number(a) ^ flip) < (number(b) ^ flip);
    }
    static bool decided(bool bit) { return bit; }

    template <class V>
    std::uint32_t product(bool signed_a, const V& a, bool signed_b, const V& b) {
        const auto extended = [](bool is_signed, std::uint32_t w) {
            return is_signed ? static_cast<std::int64_t>(static_cast<std::int16_t>(w)) : std::int64_t{w};
        };
        return static_cast<std::uint32_t>(extended(signed_a, number(a)) * extended(signed_b, number(b)));
    }
    static auto low(std::uint32_t product) { return Domain::value(product & 0xFFFF); }
    /// The low word goes to that register, the high word to the next one.
    void set_pair(int reg, std::uint32_t product) {
        domain().set_whole(reg, Domain::value(product & 0xFFFF));
        domain().set_whole(reg + 1, Domain::value(product >> 16));
    }

  private:
    Domain& domain() { return static_cast<Domain&>(*this); }
    template <class V>
    std::uint32_t number(const V& value) {
        return domain().word(value);
    }
};

}  // namespace puckloop::dspic
