#pragma once
// All blocks of firmware that were translated in this process for one kind of chip. Robots run the same
// firmware: a block is made once, and found again by its program address and words.
//
// `Family` is the chip family's part, with
//   Machine, Word, Layout, Emitter   its core, its program words, what code depends on, what makes code
//   State, state(m)                  what the entry code is called with
//   translatable(layout)             whether there can be code at all for such a chip
//   serves(layout, m)                whether code for `layout` is code for `m`
//   may_begin(m, index)              whether a block may begin at that program word
//   fits(m, index, words)            whether a block that rests on these words is still what is there

#include "emu/chip/translate/code_memory.h"

#include <cstddef>
#include <cstdint>
#include <list>
#include <mutex>
#include <unordered_map>
#include <utility>
#include <vector>

namespace puckloop::chip {

template <class Family>
class CodeLibrary {
  public:
    using Machine = typename Family::Machine;

    explicit CodeLibrary(const Machine& m) : layout_(m) {
        if (!memory_.available()) return;
        typename Family::Emitter emitter(layout_, memory_.writable(), kLargestBlock, 0);
        shared_ = emitter.emit_entry_code();
        used_ = emitter.size();
        start_ = memory_.executable();
        enter_ = reinterpret_cast<Enter>(reinterpret_cast<std::uintptr_t>(start_ + shared_.enter));
    }

    /// The one for chips like the machine's; null if this host cannot execute code made here. Each `Library`
    /// is derived from this class.
    template <class Library>
    static Library* of(const Machine& m) {
        static std::mutex mutex;
        static std::list<Library> libraries;
        const std::lock_guard guard(mutex);
        for (Library& library : libraries)
            if (Family::serves(library.layout_, m)) return library.available() ? &library : nullptr;
        Library& library = libraries.emplace_back(m);
        return library.available() ? &library : nullptr;
    }

    /// Offset of the code for the block at program word `index`, made if need be; 0: there can be none.
    std::uint32_t block_at(Machine& m, std::uint32_t index) {
        const std::lock_guard guard(mutex_);
        std::vector<Block>& known = blocks_[index];
        for (const Block& block : known)
            if (Family::fits(m, index, block.words)) return block.code;
        if (!Family::may_begin(m, index) || used_ + 2 * kLargestBlock > CodeMemory::kBytes) return 0;
        Block block = make(m, index);
        if (!Family::fits(m, index, block.words)) return 0;
        return known.emplace_back(std::move(block)).code;
    }

    /// Executes from that block on; returns what the code came back with.
    int enter(Machine& m, std::uint32_t block) const { return enter_(Family::state(m), start_, block); }

  private:
    /// No block takes more.
    static constexpr std::size_t kLargestBlock = 64 << 10;
    using Enter = int (*)(typename Family::State* state, const std::uint8_t* start, std::uint32_t block);

    struct Block {
        std::uint32_t code = 0;                    ///< 0: these words cannot be translated
        std::vector<typename Family::Word> words;  ///< that it rests on
    };

    bool available() const { return memory_.available() && Family::translatable(layout_); }

    Block make(Machine& m, std::uint32_t index) {
        constexpr std::size_t kLine = 64;
        const std::size_t at = (used_ + kLine - 1) / kLine * kLine;
        typename Family::Emitter emitter(layout_, memory_.writable() + at, kLargestBlock, at);
        const bool made = emitter.emit_block(m, index, shared_);
        const auto first = m.program.begin() + index;
        Block block{0, {first, first + emitter.words()}};
        if (!made) return block;
        used_ = at + emitter.size();
        block.code = static_cast<std::uint32_t>(at);
        return block;
    }

    const typename Family::Layout layout_;
    CodeMemory memory_;
    typename Family::Emitter::Shared shared_;
    const std::uint8_t* start_ = nullptr;
    Enter enter_ = nullptr;
    std::size_t used_ = 0;
    std::mutex mutex_;
    std::unordered_map<std::uint32_t, std::vector<Block>> blocks_;
};

}  // namespace puckloop::chip
