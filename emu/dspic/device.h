#pragma once
// What tells one dsPIC from another: memories, register table, interrupt table.

#include "emu/dspic/sfr_space.h"

#include <cstdint>
#include <span>
#include <string_view>

namespace puckloop::dspic {

/// One interrupt source. Flag, enable and priority sit at the places that its number gives (IFS, IEC:
/// number/16, bit number%16; IPC: number/4, bits from 4*(number%4)); its vector is at program address 0x14 +
/// 2*number.
struct InterruptInfo {
    std::uint8_t number = 0;
    std::string_view name;      ///< "T1", "U2RX", "ADC", ...
    std::string_view flag;      ///< "T1IF"
    std::string_view enable;    ///< "T1IE"
    std::string_view priority;  ///< "T1IP"
};

/// Program addresses are those of the PC (two a word); data addresses are bytes; ends are one past the last.
struct DeviceInfo {
    std::string_view name;
    std::span<const RegisterInfo> registers;
    std::span<const InterruptInfo> interrupts;
    std::uint32_t program_end = 0;
    std::uint32_t eeprom_begin = 0;
    std::uint32_t eeprom_end = 0;
    std::uint32_t config_begin = 0;
    std::uint32_t config_end = 0;
    std::uint16_t ram_begin = 0;
    std::uint16_t ram_end = 0;
    std::uint16_t y_begin = 0;  ///< start of Y data space, which ends with the RAM
    std::uint16_t device_id = 0;
    std::uint16_t revision = 0;
};

/// The e-puck's microcontroller: 144 KB flash, 8 KB RAM, 4 KB EEPROM.
const DeviceInfo& dspic30f6014a();

/// By name, without regard to case ("dspic30f6014a"); null if no such device is modelled.
const DeviceInfo* find_device(std::string_view name);

}  // namespace puckloop::dspic
