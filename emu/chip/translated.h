#pragma once
// Translated code as one machine sees it: which program words begin a block, and how often others were come
// to. Blocks themselves are shared by all machines of the process, in a family's library
// (translate/library.h).

#include <cstdint>
#include <cstdlib>

namespace puckloop::chip {

template <class Library>
struct Translated {
    bool on = true;              ///< Core::set_translate()
    std::uint8_t hot = 0;        ///< arrivals that make a block
    Library* library = nullptr;  ///< null: nothing is translated (yet)
    /// By program word: offset of the block's code, 0 = none. The pages are taken as they are used.
    std::uint32_t* entries = nullptr;
    std::uint8_t* heat = nullptr;  ///< by program word: arrivals without a block

    Translated() = default;
    ~Translated() {
        std::free(entries);
        std::free(heat);
    }
    Translated(const Translated&) = delete;
    Translated& operator=(const Translated&) = delete;
};

}  // namespace puckloop::chip
