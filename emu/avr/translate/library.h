#pragma once
// All blocks translated in this process for one kind of chip. A block is made once, and found again by its
// program address and words.

#include "emu/avr/machine/machine.h"

namespace puckloop::avr::translate {

class Library;

/// Why translated code came back. Machine::current is the next operation.
enum class Left : int {
    NoEntry,  ///< it does not begin a block (yet)
    Slow,     ///< the interpreter executes it, then translated code may go on
    Limit,    ///< too little time for the block
};

/// No block rests on more program words.
inline constexpr std::uint32_t kMostWords = 80;

/// The library for the core's kind of chip; null if this host cannot execute code made here (it is not
/// x86-64, or allows no executable memory).
Library* library_for(const Machine& m);
/// Offset of the code for the block at program word `index`, made if need be; 0: there can be none.
std::uint32_t block_at(Library& library, Machine& m, std::uint32_t index);
/// Executes from that block on.
Left enter(const Library& library, Machine& m, std::uint32_t block);

}  // namespace puckloop::avr::translate
