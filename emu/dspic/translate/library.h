#pragma once
// All blocks translated in this process for one kind of chip. Robots run the same firmware: a block is made
// once, and found again by its program address and words.

#include "emu/chip/translate/left.h"
#include "emu/dspic/machine/machine.h"

namespace puckloop::dspic::translate {

class Library;

/// The library for the machine's kind of chip; null if this host cannot execute code made here (it is not
/// x86-64, or allows no executable memory).
Library* library_for(const Machine& m);
/// Offset of the code for the block at program word `index`, made if need be; 0: there can be none.
std::uint32_t block_at(Library& library, Machine& m, std::uint32_t index);
/// Executes from that block on.
chip::Left enter(const Library& library, Machine& m, std::uint32_t block);

}  // namespace puckloop::dspic::translate
