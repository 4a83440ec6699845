#pragma once
// The registers of every device, at compile time.

#include "emu/dspic/devices/register_info.h"

namespace puckloop::dspic {

#define REGISTER(name, address, reset, implemented, fields) {#name, address, reset, implemented, fields},
inline constexpr RegisterInfo kRegisters30F6014A[] = {
#include "emu/dspic/devices/dspic30f6014a_registers.inc"
};
inline constexpr RegisterInfo kRegisters33FJ256GP710[] = {
#include "emu/dspic/devices/dspic33fj256gp710_registers.inc"
};
#undef REGISTER

}  // namespace puckloop::dspic
