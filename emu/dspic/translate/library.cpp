#include "emu/dspic/translate/library.h"

#include "emu/chip/code_memory.h"
#include "emu/dspic/translate/emitter.h"

#include <list>
#include <mutex>
#include <unordered_map>

namespace puckloop::dspic::translate {

namespace {

/// No block takes more.
constexpr std::size_t kLargestBlock = 64 << 10;

struct Block {
    std::uint32_t code = 0;            ///< 0: these words cannot be translated
    std::vector<std::uint32_t> words;  ///< the last ones were only looked at
};

/// The block's words are there and decoded, and none of them carries a mark.
bool fits(const Machine& m, std::uint32_t index, const Block& block) {
    for (std::size_t i = 0; i < block.words.size(); ++i)
        if (m.program[index + i] != block.words[i]) return false;
    for (std::size_t i = 0; i + Emitter::kLookedAt < block.words.size(); ++i) {
        const Op& op = m.code[index + i];
        if (op.marks || op.run == &decode_now) return false;
    }
    return true;
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

    bool available() const { return memory_.available(); }
    bool serves(const Machine& m) const {
        return layout_.ram_words == m.ram_words && layout_.code_words == m.code_words &&
               layout_.ifs == m.device.ifs && layout_.iec == m.device.iec &&
               layout_.ifs_words == m.device.ifs_words;
    }

    std::uint32_t block_at(Machine& m, std::uint32_t index) {
        const std::lock_guard guard(mutex_);
        std::vector<Block>& known = blocks_[index];
        for (const Block& block : known)
            if (fits(m, index, block)) return block.code;
        if (m.code[index].marks || used_ + 2 * kLargestBlock > chip::CodeMemory::kBytes) return 0;
        return known.emplace_back(make(m, index)).code;
    }

    Left enter(Machine& m, std::uint32_t block) const {
        return static_cast<Left>(enter_(&m.st, start_, block));
    }

  private:
    using Enter = int (*)(CoreState* state, const std::uint8_t* start, std::uint32_t block);

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

}  // namespace puckloop::dspic::translate
