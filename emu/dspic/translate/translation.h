#pragma once
// Translated code as one machine sees it: which program words begin a block, and how often others were come
// to. Blocks themselves are shared by all machines of the process (library.h).

#include <cstdint>

namespace puckloop::dspic {

struct Machine;
namespace translate {
class Library;
}

struct Translated {
    bool on = true;                         ///< Core::set_translate()
    std::uint8_t hot = 0;                   ///< arrivals that make a block
    translate::Library* library = nullptr;  ///< null: nothing is translated (yet)
    /// By program word: offset of the block's code, 0 = none. The pages are taken as they are used.
    std::uint32_t* entries = nullptr;
    /// By program word: arrivals without a block.
    std::uint8_t* heat = nullptr;

    Translated() = default;
    ~Translated();
    Translated(const Translated&) = delete;
    Translated& operator=(const Translated&) = delete;
};

/// Executes from Machine::current on while the cycle is below Machine::limit, exactly as the interpreter
/// would; RA is not set.
void run_translated(Machine& m);
/// The operation at this program word changed: blocks that rest on it are not entered any more.
void forget_blocks(Machine& m, std::uint32_t index);
void forget_all_blocks(Machine& m);

}  // namespace puckloop::dspic
