#pragma once
// Addresses of the dsPIC33FJ256GP710's registers by their data-sheet names: sfr33::T1CON, sfr33::U2STA, ...

#include <cstdint>

namespace puckloop::dspic::sfr33 {

#define REGISTER(name, address, reset, implemented, fields) inline constexpr std::uint16_t name = address;
#include "emu/dspic/devices/dspic33fj256gp710_registers.inc"
#undef REGISTER

}  // namespace puckloop::dspic::sfr33
