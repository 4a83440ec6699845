#pragma once
// The fields of a register, as the devices' tables write them: "WGM:1:0 TON:15", high bit first.

#include "debug/debug_chip.h"

#include <string_view>
#include <vector>

namespace puckloop::debug {

/// Each field with what it holds in `value`.
std::vector<DebugChip::Field> fields_of(std::string_view table, std::uint32_t value);

}  // namespace puckloop::debug
