#pragma once
// A byte that has another value in each of many turns of a loop: one lane per turn, operated on side by side.
// Has the operators of a byte, so that the formulas of core/alu.h serve for it as for one.

#include "emu/avr/machine/state.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

namespace puckloop::avr {

class Lanes {
  public:
    static constexpr std::size_t kCount = 64;

    Lanes() = default;  ///< undefined lanes
    /// The same in every lane.
    explicit Lanes(std::uint8_t value) {
        for (Part& part : parts_)
            part = Part{} + value;
    }
    static Lanes of(const std::array<std::uint8_t, kCount>& values) {
        Lanes lanes;
        std::memcpy(&lanes.parts_, values.data(), kCount);
        return lanes;
    }

    std::uint8_t operator[](std::size_t lane) const {
        std::uint8_t value = 0;
        std::memcpy(&value, reinterpret_cast<const char*>(&parts_) + lane, 1);
        return value;
    }
    /// Bit n is set where lane n is 0.
    std::uint64_t zeros() const {
        std::uint64_t mask = 0;
        for (std::size_t i = 0; i < kParts; ++i)
            mask |= std::uint64_t{sign_bits(parts_[i] == 0)} << (i * kWidth);
        return mask;
    }
    /// 0xFF in the lanes that are 0, else 0.
    Lanes is_zero() const {
        return each([](Part a) { return reinterpret_cast<Part>(a == 0); });
    }

    friend Lanes operator+(const Lanes& a, const Lanes& b) {
        return both(a, b, [](Part x, Part y) { return x + y; });
    }
    friend Lanes operator-(const Lanes& a, const Lanes& b) {
        return both(a, b, [](Part x, Part y) { return x - y; });
    }
    friend Lanes operator&(const Lanes& a, const Lanes& b) {
        return both(a, b, [](Part x, Part y) { return x & y; });
    }
    friend Lanes operator|(const Lanes& a, const Lanes& b) {
        return both(a, b, [](Part x, Part y) { return x | y; });
    }
    friend Lanes operator^(const Lanes& a, const Lanes& b) {
        return both(a, b, [](Part x, Part y) { return x ^ y; });
    }
    friend Lanes operator&(const Lanes& a, std::uint8_t b) { return a & Lanes(b); }
    friend Lanes operator|(const Lanes& a, std::uint8_t b) { return a | Lanes(b); }
    Lanes operator~() const {
        return each([](Part a) { return ~a; });
    }
    Lanes operator<<(int count) const {
        return each([count](Part a) { return a << count; });
    }
    Lanes operator>>(int count) const {
        return each([count](Part a) { return a >> count; });
    }

  private:
    static constexpr std::size_t kWidth = 16, kParts = kCount / kWidth;
    using Part = std::uint8_t __attribute__((vector_size(kWidth)));
    using Mask = decltype(Part{} == 0);

    static std::uint32_t sign_bits(const Mask& mask) {
#ifdef __SSE2__
        return static_cast<std::uint32_t>(
            __builtin_ia32_pmovmskb128(reinterpret_cast<char __attribute__((vector_size(kWidth)))>(mask)));
#else
        std::uint32_t bits = 0;
        for (std::size_t i = 0; i < kWidth; ++i)
            bits |= std::uint32_t{mask[i] != 0} << i;
        return bits;
#endif
    }
    template <class Operation>
    Lanes each(Operation operation) const {
        Lanes result;
        for (std::size_t i = 0; i < kParts; ++i)
            result.parts_[i] = operation(parts_[i]);
        return result;
    }
    template <class Operation>
    static Lanes both(const Lanes& a, const Lanes& b, Operation operation) {
        Lanes result;
        for (std::size_t i = 0; i < kParts; ++i)
            result.parts_[i] = operation(a.parts_[i], b.parts_[i]);
        return result;
    }

    std::array<Part, kParts> parts_;
};

inline Lanes zero_flag(const Lanes& value) {
    return value.is_zero() & sreg::Z;
}

}  // namespace puckloop::avr
