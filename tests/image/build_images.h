#pragma once
// Valid images made in memory, for the loaders' tests and the mutation test: the same small program in each
// format.

#include "emu/image/image.h"

#include <string>

namespace puckloop::image::testing {

/// goto 0x100 at 0, a few words at 0x100, one configuration word, one EEPROM word.
Words sample_words();

std::string hex_image();
/// ELF32 with .reset, .text, __FOSC, .eedata, .bss, symbols _main, _counter, .L1, __30F6014A.
std::string elf_image();
/// COFF with the same, and a section whose long name stands in the string table.
std::string coff_image();

}  // namespace puckloop::image::testing
