#include "emu/dspic/translate/library.h"

#include "emu/chip/translate/code_library.h"
#include "emu/dspic/translate/emitter.h"

namespace puckloop::dspic::translate {

namespace {

struct Family {
    using Machine = dspic::Machine;
    using Word = std::uint32_t;
    using Layout = translate::Layout;
    using Emitter = translate::Emitter;
    using State = CoreState;

    static State* state(Machine& m) { return &m.st; }
    static bool translatable(const Layout&) { return true; }
    static bool serves(const Layout& layout, const Machine& m) {
        return layout.ram_words == m.ram_words && layout.code_words == m.code_words &&
               layout.ifs == m.device.ifs && layout.iec == m.device.iec &&
               layout.ifs_words == m.device.ifs_words;
    }
    static bool may_begin(const Machine& m, std::uint32_t index) { return !m.code[index].marks; }
    /// The words are there and decoded, and none of them carries a mark. The last ones were only looked at.
    static bool fits(const Machine& m, std::uint32_t index, const std::vector<Word>& words) {
        for (std::size_t i = 0; i < words.size(); ++i)
            if (m.program[index + i] != words[i]) return false;
        for (std::size_t i = 0; i + Emitter::kLookedAt < words.size(); ++i) {
            const Op& op = m.code[index + i];
            if (op.marks || op.run == &decode_now) return false;
        }
        return true;
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

}  // namespace puckloop::dspic::translate
