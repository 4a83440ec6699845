#pragma once
// What an image calls its places, of either family of chips.

#include "debug/debug_chip.h"
#include "emu/image/image.h"
#include "emu/image/line_table.h"

#include <map>
#include <string>

namespace puckloop::tools {

struct ImageNames {
    std::map<std::string, image::Symbol> symbols;
    image::LineTable lines;
};

/// Of the two families that there are.
inline bool is_avr(const debug::DebugChip& chip) {
    return !chip.architecture().empty();  // GDB knows no dsPIC
}

/// `avr`: an image for a TAM, else one for a dsPIC. Throws InputError: the file cannot be read.
ImageNames names_in(const std::string& firmware, bool avr);

}  // namespace puckloop::tools
