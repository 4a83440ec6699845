#pragma once
// What reports say of a program that goes wrong, with its place.

#include "emu/avr/chip/chip.h"

#include <cstdint>
#include <optional>
#include <string>

namespace puckloop::avr {

/// "pc 0x0012a", with symbol and source line where the image has them: "pc 0x0012a in main+0x12 (main.c:12)".
std::string place_text(const Chip& chip, std::uint32_t pc);
/// One line about resets that no program asks for; nullopt if there are none.
std::optional<std::string> crash_text(const Chip& chip, const ChipReport& report);

}  // namespace puckloop::avr
