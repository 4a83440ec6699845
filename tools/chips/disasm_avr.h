#pragma once
// The AVR half of `puckloop disasm`.

#include "emu/avr/devices/device.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::tools {

struct DisasmAvr {
    std::string image;
    std::string start, end;  ///< byte addresses in hexadecimal, or symbols
    std::vector<std::string> words;
};

/// The listing of an image, or of `words`. Throws InputError.
std::string disassemble_avr(const DisasmAvr& what, const avr::DeviceInfo& device);

/// A hexadecimal number up to `largest`, 0x in front or not.
std::optional<std::uint32_t> hexadecimal(std::string_view text, std::uint32_t largest);

}  // namespace puckloop::tools
