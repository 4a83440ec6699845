#include "emu/avr/translate/library.h"

#include "emu/avr/translate/emitter.h"
#include "emu/chip/translate/code_library.h"

#include <algorithm>

namespace puckloop::avr::translate {

namespace {

struct Family {
    using Machine = avr::Machine;
    using Word = std::uint16_t;
    using Layout = translate::Layout;
    using Emitter = translate::Emitter;
    using State = Machine;

    static State* state(Machine& m) { return &m; }
    /// RAM is recognised by the upper bytes of its addresses (Layout::Tables::not_ram).
    static bool translatable(const Layout& layout) {
        return layout.ram_start % 256 == 0 && layout.ram_bytes % 256 == 0;
    }
    static bool serves(const Layout& layout, const Machine& m) {
        return layout.flash_words == m.device.flash_words && layout.ram_start == m.ram_start &&
               layout.ram_bytes == m.ram_bytes;
    }
    static bool may_begin(const Machine&, std::uint32_t) { return true; }
    /// The words are there, and no stop address is among them.
    static bool fits(const Machine& m, std::uint32_t index, const std::vector<Word>& words) {
        if (!std::equal(words.begin(), words.end(), m.program.begin() + index)) return false;
        return std::none_of(m.stops.begin(), m.stops.end(),
                            [&](std::uint16_t stop) { return stop >= index && stop < index + words.size(); });
    }
};

}  // namespace

class Library : public chip::CodeLibrary<Family> {
  public:
    using CodeLibrary::CodeLibrary;
};

Library* library_for(const Machine& m) {
    return Library::of<Library>(m);
}

std::uint32_t block_at(Library& library, Machine& m, std::uint32_t index) {
    return library.block_at(m, index);
}

chip::Left enter(const Library& library, Machine& m, std::uint32_t block) {
    return static_cast<chip::Left>(library.enter(m, block));
}

}  // namespace puckloop::avr::translate
