#pragma once
// Program memory as assembler source: labels, instructions, address and words as comment. What it writes, the
// assembler turns back into the same bytes.

#include "emu/image/byte_segments.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace puckloop::avr {

struct ListingOptions {
    std::uint32_t start = 0;                           ///< first byte address, even
    std::uint32_t end = 0x1FFFF;                       ///< last one
    std::multimap<std::uint32_t, std::string> labels;  ///< names by byte address
};

/// Branch targets without a name become L_1234.
std::string list_program(const std::vector<image::ByteSegment>& segments, const ListingOptions& options = {});

}  // namespace puckloop::avr
