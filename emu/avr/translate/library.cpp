#include "emu/avr/translate/library.h"

#include "emu/avr/translate/emitter.h"
#include "emu/chip/code_memory.h"

#include <algorithm>
#include <list>
#include <mutex>
#include <unordered_map>

namespace puckloop::avr::translate {

namespace {

/// No block takes more.
constexpr std::size_t kLargestBlock = 64 << 10;

struct Block {
    std::uint32_t code = 0;            ///< 0: these words cannot be translated
    std::vector<std::uint16_t> words;  ///< that it rests on
};

/// The block's words are there, and no stop address is among them.
bool fits(const Machine& m, std::uint32_t index, const Block& block) {
    if (!std::equal(block.words.begin(), block.words.end(), m.program.begin() + index)) return false;
    return std::none_of(m.stops.begin(), m.stops.end(), [&](std::uint16_t stop) {
        return stop >= index && stop < index + block.words.size();
    });
}

}  // namespace

class Library {
  public:
    explicit Library(const Machine& m) : layout_(m) {
        if (!memory_.available()) return;
        Emitter emitter(layout_, memory_.writable(), kLargestBlock, 0);
        shared_ = emitter.emit_entry_code();
        used_ = emitter.size();
        start_ = memory_.executable();
        enter_ = reinterpret_cast<Enter>(reinterpret_cast<std::uintptr_t>(start_ + shared_.enter));
    }

    /// Memory is told apart by upper bytes of addresses (Layout::Tables::not_ram).
    bool available() const {
        return memory_.available() && layout_.ram_start % 256 == 0 && layout_.ram_bytes % 256 == 0;
    }
    bool serves(const Machine& m) const {
        return layout_.flash_words == m.device.flash_words && layout_.ram_start == m.ram_start &&
               layout_.ram_bytes == m.ram_bytes;
    }

    std::uint32_t block_at(Machine& m, std::uint32_t index) {
        const std::lock_guard guard(mutex_);
        std::vector<Block>& known = blocks_[index];
        for (const Block& block : known)
            if (fits(m, index, block)) return block.code;
        if (used_ + 2 * kLargestBlock > chip::CodeMemory::kBytes) return 0;
        Block block = make(m, index);
        if (!fits(m, index, block)) return 0;
        return known.emplace_back(std::move(block)).code;
    }

    Left enter(Machine& m, std::uint32_t block) const { return static_cast<Left>(enter_(&m, start_, block)); }

  private:
    using Enter = int (*)(Machine* machine, const std::uint8_t* start, std::uint32_t block);

    Block make(Machine& m, std::uint32_t index) {
        constexpr std::size_t kLine = 64;
        const std::size_t at = (used_ + kLine - 1) / kLine * kLine;
        Emitter emitter(layout_, memory_.writable() + at, kLargestBlock, at);
        const bool made = emitter.emit_block(m, index, shared_);
        const auto first = m.program.begin() + index;
        Block block{0, {first, first + emitter.words()}};
        if (!made) return block;
        used_ = at + emitter.size();
        block.code = static_cast<std::uint32_t>(at);
        return block;
    }

    const Layout layout_;
    chip::CodeMemory memory_;
    Emitter::Shared shared_;
    const std::uint8_t* start_ = nullptr;
    Enter enter_ = nullptr;
    std::size_t used_ = 0;
    std::mutex mutex_;
    std::unordered_map<std::uint32_t, std::vector<Block>> blocks_;
};

Library* library_for(const Machine& m) {
    static std::mutex mutex;
    static std::list<Library> libraries;
    const std::lock_guard guard(mutex);
    for (Library& library : libraries)
        if (library.serves(m)) return library.available() ? &library : nullptr;
    Library& library = libraries.emplace_back(m);
    return library.available() ? &library : nullptr;
}

std::uint32_t block_at(Library& library, Machine& m, std::uint32_t index) {
    return library.block_at(m, index);
}

Left enter(const Library& library, Machine& m, std::uint32_t block) {
    return library.enter(m, block);
}

}  // namespace puckloop::avr::translate
