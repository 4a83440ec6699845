#pragma once
// What a peripheral sees of the chip around it: its registers, the timetable, the present cycle, and the
// interrupt controller.

#include "emu/dspic/machine/event_queue.h"
#include "emu/dspic/machine/interrupts.h"
#include "emu/dspic/machine/sfr_space.h"

#include <cstdint>

namespace puckloop::dspic {

/// References into the chip; they outlive every peripheral.
///
/// Time in the models: a register access happens at `now`, the cycle in which its instruction starts; what
/// a write changes takes effect one cycle later, at now + 1. An event handler works at the cycle that it
/// was due.
struct Surroundings {
    SfrSpace& sfr;
    EventQueue& events;
    const Cycle& now;
    InterruptController& interrupts;
};

/// Bits `high`..`low` of a register value.
constexpr unsigned field(unsigned value, int high, int low) {
    return value >> low & ((1u << (high - low + 1)) - 1u);
}
/// A mask with one bit set.
constexpr std::uint16_t bit(int number) {
    return static_cast<std::uint16_t>(1u << number);
}
/// Sets or clears the bits of `mask` in a register.
constexpr void assign(std::uint16_t& reg, std::uint16_t mask, bool on) {
    reg = static_cast<std::uint16_t>(on ? reg | mask : reg & ~mask);
}
/// The old value with the bytes of `mask` replaced.
constexpr std::uint16_t merge(std::uint16_t old, std::uint16_t value, std::uint16_t mask) {
    return static_cast<std::uint16_t>((old & ~mask) | (value & mask));
}

}  // namespace puckloop::dspic
