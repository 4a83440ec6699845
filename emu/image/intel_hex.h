#pragma once
// Intel HEX, as bytes by byte address. Source: Intel "Hexadecimal Object File Format Specification" rev. A.
// 1. Start-address records (03, 05) are checked and otherwise ignored: these chips start at their reset
// vector.
// 2. A record may run over the end of its 64 KB bank of linear addresses (Microchip's tools write such
// records); the
//    offset then counts on instead of wrapping. 3. Blank lines and trailing white space are accepted;
//    anything after the end-of-file record is an error.

#include "emu/image/byte_segments.h"

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::image {

/// Sorted, joined segments. `file` is named in every InputError, with the line.
std::vector<ByteSegment> parse_intel_hex(std::string_view text, std::string_view file);

/// The bytes as Intel HEX text: 16-byte records, extended linear address records, end-of-file record.
std::string write_intel_hex(const std::vector<ByteSegment>& segments);

/// Program words by program address in Microchip's convention: byte address = 2 * program address, low byte
/// first, fourth (phantom) byte zero.
std::string write_dspic_hex(const std::map<std::uint32_t, std::uint32_t>& words);

}  // namespace puckloop::image
