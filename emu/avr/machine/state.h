#pragma once
// Everything an AVR core remembers, in one plain struct, with the data sheet's names. Data RAM, program
// memory and the registers of other modules live beside it.

#include "emu/avr/devices/device.h"

#include <array>
#include <cstdint>

namespace puckloop::avr {

/// Bits of SREG.
namespace sreg {
inline constexpr std::uint8_t C = 1u << 0, Z = 1u << 1, N = 1u << 2, V = 1u << 3, S = 1u << 4, H = 1u << 5,
                              T = 1u << 6, I = 1u << 7;
}  // namespace sreg

struct CoreState {
    std::array<std::uint8_t, 32> r{};
    std::uint8_t sreg = 0;
    std::uint8_t rampz = 0;
    std::uint16_t sp = 0;
    std::uint16_t pc = 0;  ///< counts words
    Cycle cycle = 0;       ///< the next instruction starts here

    friend bool operator==(const CoreState&, const CoreState&) = default;
};

}  // namespace puckloop::avr
