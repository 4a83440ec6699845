#pragma once
// What every peripheral is connected to, and the bits that it works with.

#include "emu/avr/devices/device.h"
#include "emu/avr/machine/interrupts.h"

#include <cstdint>

namespace puckloop::avr {

struct Surroundings {
    IoSpace& io;
    EventQueue& events;
    InterruptController& interrupts;
    const Cycle& now;  ///< of the register access in progress
};

constexpr std::uint8_t bit(int number) {
    return static_cast<std::uint8_t>(1u << number);
}
/// Bits high..low of a register as a number.
constexpr unsigned field(unsigned value, int high, int low) {
    return value >> low & ((1u << (high - low + 1)) - 1u);
}
/// Sets or clears the bits of `mask`.
constexpr void assign(std::uint8_t& target, std::uint8_t mask, bool on) {
    target = static_cast<std::uint8_t>(on ? target | mask : target & ~mask);
}
/// `value` where `mask` is set, `old` elsewhere.
constexpr std::uint8_t merged(std::uint8_t old, std::uint8_t value, std::uint8_t mask) {
    return static_cast<std::uint8_t>((old & ~mask) | (value & mask));
}

}  // namespace puckloop::avr
