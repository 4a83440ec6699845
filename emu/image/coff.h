#pragma once
// COFF as Microchip's C30 writes it. Source: layout of the usual COFF (file header 20 bytes, section header
// 40, symbol 18), with the dsPIC's conventions as seen in a real C30 image: two file bytes a program address,
// long section names as "/offset" into the string table, .const sections placed at s_paddr and addressed
// through PSV at s_vaddr.
// 1. Debugging symbols are skipped. 2. Relocations are an error: only linked images are read.

#include "emu/image/image.h"
#include "emu/image/line_table.h"

#include <cstdint>
#include <string_view>

namespace puckloop::image {

inline constexpr std::uint64_t kCoffSymbolSize = 18;
inline constexpr std::uint8_t kClassExternal = 2, kClassStatic = 3;  ///< of a symbol's storage

bool is_coff(std::string_view bytes);
/// Adds words, symbols and the chip. Throws InputError naming the offset.
void read_coff(std::string_view bytes, Image& image);
/// Source lines; where these are damaged reading ends, and what was read so far stays.
LineTable read_coff_lines(std::string_view bytes, const std::string& file);

}  // namespace puckloop::image
