#pragma once
// Which words an interrupt routine writes by their address, found by following its code without running it.
// Writes through pointers are not seen, computed jumps not followed: "names it" is evidence, "does not" is
// none.

#include <cstdint>
#include <functional>

namespace puckloop::dspic {

/// `word(address)` is the program word at an even address.
using ProgramReader = std::function<std::uint32_t(std::uint32_t address)>;

/// True if code reachable from `entry` writes the data word at `address` directly, or loads that address as a
/// literal.
bool routine_names(const ProgramReader& word, std::uint32_t entry, std::uint16_t address);

}  // namespace puckloop::dspic
