#pragma once
// What a user names in a debugger: variables, registers, their fields and bits, data addresses.

#include "bench/debugger/program.h"
#include "debug/debug_chip.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::exec::debugger {

/// A place that has a value.
struct Place {
    std::string name;                 ///< as the user wrote it
    std::optional<std::size_t> core;  ///< number of a register of the core
    std::uint16_t address = 0;        ///< data address of all others
    std::uint32_t bytes = 1;
    int shift = 0;               ///< of a field or bit within them
    std::uint64_t mask = ~0ull;  ///< before the shift; all ones: no field
    bool field = false;
    bool special = false;  ///< a register of the data sheet
    bool integer = false;  ///< shown as one number
};

/// NAME, NAME[INDEX], NAME:BYTES and NAME:BYTES[INDEX] of variables and of 0xADDRESS (data space), REGISTER,
/// REGISTER.FIELD, REGISTER.BIT, of the core's registers pc, w0, r24 ... too, perhaps with a $ in front.
/// Throws InputError, with the name that was meant.
Place place_of(std::string_view text, const debug::DebugChip& chip, const Program& program);

/// What is there now; nothing: memory that does not exist.
std::optional<std::vector<std::uint8_t>> bytes_of(const Place& place, const debug::DebugChip& chip);
std::optional<std::uint64_t> number_of(const Place& place, const debug::DebugChip& chip);
/// As text: "3 (0x03)", "06 03 00 0c"; registers with their fields. `format`: x, d (signed), u, t (binary), s
/// (text) or 0.
std::string shown(const Place& place, const debug::DebugChip& chip, char format);
/// False: it cannot be written.
bool write(const Place& place, debug::DebugChip& chip, std::uint64_t value);
/// Names for completion.
std::vector<std::string> place_names(const debug::DebugChip& chip, const Program& program);
/// Fields of each of the registers with interrupts' enables and flags that are set: "T1IE T1IF".
std::string interrupts(const debug::DebugChip& chip);

}  // namespace puckloop::exec::debugger
