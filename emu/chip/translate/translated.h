#pragma once
// Translated code as one machine sees it: which program words begin a block, and how often others were come
// to. Blocks themselves are shared by all machines of the process, in a family's library
// (translate/library.h).

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <utility>

namespace puckloop::chip {

template <class Library>
struct Translated {
    bool on = true;              ///< Core::set_translate()
    std::uint8_t hot = 0;        ///< arrivals that make a block
    Library* library = nullptr;  ///< null: nothing is translated (yet)
    /// By program word: offset of the block's code, 0 = none. The pages are taken as they are used.
    std::uint32_t* entries = nullptr;
    std::uint8_t* heat = nullptr;  ///< by program word: arrivals without a block, or kNever
    std::uint32_t words = 0;       ///< of program, once prepared

    /// The heat of a place that was tried.
    static constexpr std::uint8_t kNever = 255;

    Translated() = default;
    ~Translated() { forget_all(); }
    Translated(const Translated&) = delete;
    Translated& operator=(const Translated&) = delete;

    /// For a program of that many words. False: the host cannot, and this machine does not ask again.
    bool prepare(Library* of_process, std::uint32_t program_words) {
        library = of_process;
        words = program_words;
        if (library) {
            entries = static_cast<std::uint32_t*>(std::calloc(words, sizeof *entries));
            heat = static_cast<std::uint8_t*>(std::calloc(words, sizeof *heat));
        }
        if (library && entries && heat) return true;
        library = nullptr;
        on = false;
        return false;
    }

    /// The block at this word, if there is one or it is time to `make()` it; 0: none.
    template <class Make>
    std::uint32_t block_at(std::uint32_t index, Make make) {
        if (entries[index] != 0) return entries[index];
        if (heat[index] == kNever || ++heat[index] < hot) return 0;
        entries[index] = make();
        heat[index] = kNever;
        return entries[index];
    }

    /// The operation at this word changed: blocks that rest on it are not entered any more. None rests on
    /// more than `most` words.
    void forget(std::uint32_t index, std::uint32_t most) {
        if (!library || index >= words) return;
        const std::uint32_t first = index < most ? 0 : index - most;
        std::fill(entries + first, entries + index + 1, 0);
        std::fill(heat + first, heat + index + 1, std::uint8_t{0});
    }
    void forget_all() {
        std::free(std::exchange(entries, nullptr));
        std::free(std::exchange(heat, nullptr));
        library = nullptr;
    }
};

}  // namespace puckloop::chip
