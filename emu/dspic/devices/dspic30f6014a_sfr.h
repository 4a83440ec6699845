#pragma once
// Addresses of the dsPIC30F6014A's registers by their data-sheet names: sfr::T1CON, sfr::U2STA, ...

#include <cstdint>

namespace puckloop::dspic::sfr {

#define REGISTER(name, address, reset, implemented, fields) inline constexpr std::uint16_t name = address;
#include "emu/dspic/devices/dspic30f6014a_registers.inc"
#undef REGISTER

}  // namespace puckloop::dspic::sfr
