#pragma once
// Interrupt request numbers of the dsPIC30F6014A by name: irq::T1, irq::U2RX, irq::ADC, ...

#include <cstdint>

namespace puckloop::dspic::irq {

#define INTERRUPT(number, name, flag, enable, priority) inline constexpr std::uint8_t name = number;
#include "emu/dspic/devices/dspic30f6014a_interrupts.inc"
#undef INTERRUPT

}  // namespace puckloop::dspic::irq
