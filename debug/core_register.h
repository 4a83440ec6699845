#pragma once
// Registers of the core by the names that people type, in letters of either case.

#include "debug/debug_chip.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace puckloop::debug {

/// As data sheets write names.
std::string upper_case(std::string_view name);

/// Its place in DebugChip::registers(); nothing: the core has none of this name.
std::optional<std::size_t> core_register(std::string_view name, const DebugChip& chip);

}  // namespace puckloop::debug
