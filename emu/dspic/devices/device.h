#pragma once
// What differs between parts of the family: sizes, places and numbers. One row a device; the core and the
// peripherals read their differences here and nowhere else.

#include "emu/dspic/devices/register_info.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace puckloop::dspic {

/// A word of flash that is erased.
inline constexpr std::uint32_t kErasedWord = 0xFFFFFF;

/// A user interrupt source: its number (IRQ 0 = INT0), the data sheet's name without "Interrupt", and its
/// bits.
struct IrqName {
    std::uint8_t irq = 0;
    std::string_view name;
    std::string_view flag;      ///< "T1IF"
    std::string_view enable;    ///< "T1IE"
    std::string_view priority;  ///< "T1IP"
};

/// What hardware does to bits while a program runs: one line of devices/*_status_bits.inc.
struct StatusBits {
    std::string_view registers;  ///< name; ? is any one character
    std::string_view bits;       ///< names of the register table, or "*"
    bool modelled = false;       ///< a model changes them; false: silicon alone does
};

struct DeviceInfo {
    std::string_view name;     ///< lower case, as on the command line: "dspic30f6014a"
    bool family_33f = false;   ///< 33FJ rules where they differ from the 30F's
    int clocks_per_cycle = 4;  ///< oscillator clocks in one instruction cycle: 4 on 30F, 2 on 33FJ

    // Program space, in program-counter units (2 a word).
    std::uint32_t flash_end = 0;      ///< first address past user flash
    std::uint32_t vectors_start = 4;  ///< vector space: instructions are not fetched from here ...
    std::uint32_t vectors_end = 0;    ///< ... up to here
    std::uint32_t ivt = 4;            ///< vector 0
    std::uint32_t aivt = 0;           ///< vector 0 when INTCON2<ALTIVT> is set
    std::uint32_t row_words = 32;     ///< flash words programmed at a time
    std::uint32_t erase_words = 32;   ///< flash words erased at a time
    std::uint32_t eeprom_start = 0;   ///< first EEPROM word
    std::uint32_t eeprom_words = 0;   ///< 0: no data EEPROM
    std::uint32_t config_start = 0xF80000;
    std::uint32_t config_words = 0;
    std::uint32_t unit_id_start = 0;  ///< words a programmer may leave a serial number in
    std::uint32_t unit_id_words = 0;
    std::uint16_t devid = 0;   ///< at 0xFF0000
    std::uint16_t devrev = 0;  ///< at 0xFF0002

    // Data space, byte addresses; RAM begins where the SFR space ends.
    std::uint16_t ram_start = 0x0800;
    std::uint16_t ram_end = 0;
    std::uint16_t y_start = 0;  ///< Y prefetches reach [y_start, ram_end)

    std::span<const RegisterInfo> registers;  ///< of the SFR space, by address
    std::span<const StatusBits> status_bits;  ///< what hardware changes (waits/status_bits.h)

    // Interrupt registers: IFS0, IEC0, IPC0 and how many of each follow at successive words.
    std::uint16_t ifs = 0;
    std::uint16_t iec = 0;
    std::uint16_t ipc = 0;
    std::uint16_t inttreg = 0;  ///< 0: the part has none
    int ifs_words = 0;
    int irq_count = 0;  ///< vectors behind the traps, reserved ones included
    std::span<const IrqName> irqs;

    /// Number of a user interrupt by name ("U2RX", "T1", "AD" spelled as in the vector table), if it exists.
    std::optional<int> irq(std::string_view irq_name) const;
    /// "U2RX", "MathError"; "Reserved" for a vector without a source. `vector` counts from 0 = IVT entry 0.
    std::string_view vector_name(int vector) const;
};

/// Number of trap vectors in front of INT0.
inline constexpr int kTrapVectors = 8;

const DeviceInfo& dspic30f6014a();
const DeviceInfo& dspic33fj256gp710();
/// Every device this program knows.
std::span<const DeviceInfo* const> devices();
/// By command-line name, lower case; null if unknown.
const DeviceInfo* find_device(std::string_view name);
/// Their names, for messages: "dspic30f6014a, ...".
std::string device_names();

}  // namespace puckloop::dspic
