#pragma once
// ELF32 as Microchip's XC16 writes it, through libelf. Source: System V ABI (ELF), e_machine 118
// (EM_DSPIC30F), and the dsPIC's conventions as seen in a real XC16 image: two file bytes a program address;
// .const sections are placed at their segment's physical address and addressed through PSV at sh_addr.
// 1. Only sections in program memory are read: initial values of RAM sit there too, in .dinit.
// 2. Debugging sections are skipped.

#include "emu/image/image.h"

#include <string_view>

namespace puckloop::image {

/// Adds words, symbols and the chip. Throws InputError naming the offset.
void read_elf(std::string_view bytes, Image& image);

}  // namespace puckloop::image
