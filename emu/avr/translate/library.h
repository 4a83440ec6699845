#pragma once
// All blocks translated in this process for one kind of chip. A block is made once, and found again by its
// program address and words.

#include "emu/avr/machine/machine.h"
#include "emu/chip/translate/left.h"

namespace puckloop::avr::translate {

class Library;

/// No block rests on more program words.
inline constexpr std::uint32_t kMostWords = 80;

/// The library for the core's kind of chip; null if this host cannot execute code made here (it is not
/// x86-64, or allows no executable memory).
Library* library_for(const Machine& m);
/// Offset of the code for the block at program word `index`, made if need be; 0: there can be none.
std::uint32_t block_at(Library& library, Machine& m, std::uint32_t index);
/// Executes from that block on.
chip::Left enter(const Library& library, Machine& m, std::uint32_t block);

}  // namespace puckloop::avr::translate
