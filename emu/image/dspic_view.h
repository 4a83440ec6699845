#pragma once
// Bytes seen as dsPIC program memory: byte address = 2 * program address, four bytes a word, low byte first,
// the fourth (phantom) byte zero. Source: fact sheet dspic/memory_map.csv.

#include "emu/image/byte_segments.h"
#include "emu/image/image.h"

#include <cstdint>

namespace puckloop::image {

/// Program address of the data EEPROM's first word.
inline constexpr std::uint32_t kEepromStart = 0x7FF000;

/// Sorts `segments` into the image's program, eeprom, config and other words. Throws InputError for a word
/// cut short, a phantom byte that is not zero, or an address beyond 24 bits. Byte addresses in messages are
/// of the HEX convention.
void add_words(Image& image, const std::vector<ByteSegment>& segments);

/// "dspic30f6014a" for the symbol "__30F6014A" that Microchip's tools define; empty for any other.
std::string chip_from_symbol(std::string_view name);

}  // namespace puckloop::image
