#pragma once
// What hardware can do to a register's bits while a program waits for them. The tables are
// devices/*_status_bits.inc, one line per register.

#include "emu/dspic/devices/device.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace puckloop::dspic {

/// Bits of the register that a model changes by itself, should the register have one.
std::uint16_t driven_bits(const DeviceInfo& device, const RegisterInfo& info);
/// Bits that silicon changes and no model does.
std::uint16_t missing_bits(const DeviceInfo& device, const RegisterInfo& info);
/// "RCON, bit BGST", "IFS0, bits T2IF and T1IF"; the register alone where all its bits are meant or they have
/// no names.
std::string register_text(const RegisterInfo& info, std::uint16_t mask);

}  // namespace puckloop::dspic
