#pragma once
// Interrupt request numbers of the dsPIC33FJ256GP710 by name: irq33::T1, irq33::U2RX, irq33::AD1, ...

#include <cstdint>

namespace puckloop::dspic::irq33 {

#define INTERRUPT(number, name, flag, enable, priority) inline constexpr std::uint8_t name = number;
#include "emu/dspic/devices/dspic33fj256gp710_interrupts.inc"
#undef INTERRUPT

}  // namespace puckloop::dspic::irq33
