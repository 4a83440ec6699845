#pragma once
// What a part of the family is: sizes, places, registers and vectors. The core and the peripherals read them
// here and nowhere else.

#include "emu/chip/event_queue.h"
#include "emu/chip/register_space.h"
#include "emu/image/avr_image.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace puckloop::avr {

/// CPU clocks since power-up. Never goes back, not even at a reset.
using Cycle = chip::Cycle;
using chip::EventQueue;
using chip::kNoCycle;

/// A word of flash that is erased.
inline constexpr std::uint16_t kErasedWord = 0xFFFF;

/// Registers have their data addresses: I/O address + 0x20. The working registers lie below.
using RegisterInfo = chip::RegisterInfo<std::uint8_t>;
using IoSpace = chip::RegisterSpace<std::uint8_t, 0x100>;

/// An interrupt vector: its number (0 = reset) and the data sheet's source name, "TIMER0_OVF".
struct VectorInfo {
    std::uint8_t number = 0;
    std::string_view name;
};

struct DeviceInfo {
    std::string_view name;  ///< lower case, as on the command line
    std::array<std::uint8_t, 3> signature{};
    int gcc_architecture = 0;  ///< avr-gcc's number: 51 is avr51
    std::uint32_t flash_words = 0;
    std::uint32_t page_words = 0;  ///< flash words erased and written at a time
    std::uint16_t ram_start = 0;
    std::uint16_t ram_bytes = 0;
    std::uint16_t eeprom_bytes = 0;
    std::span<const RegisterInfo> registers;
    std::span<const VectorInfo> vectors;

    std::uint16_t ram_end() const { return static_cast<std::uint16_t>(ram_start + ram_bytes); }
    std::uint32_t flash_bytes() const { return 2 * flash_words; }
    /// What an image must fit.
    image::AvrPart image_part() const { return {name, gcc_architecture, flash_bytes(), eeprom_bytes}; }
    /// "TIMER0_OVF"; "?" for a number without a source.
    std::string_view vector_name(int vector) const;
    /// Number of a vector by name. Throws std::out_of_range.
    int vector(std::string_view vector_name) const;
};

const DeviceInfo& atmega1284p();
/// By command-line name, lower case; null if unknown.
const DeviceInfo* find_device(std::string_view name);
/// Their names, for messages.
std::string device_names();

}  // namespace puckloop::avr
