#include "emu/dspic/translate/translation.h"

#include "emu/chip/translate/run_blocks.h"
#include "emu/dspic/machine/interpret.h"
#include "emu/dspic/machine/machine.h"
#include "emu/dspic/translate/library.h"
#include "emu/dspic/waits/wait_watch.h"

#include <utility>

namespace puckloop::dspic {

namespace {

/// No block rests on more program words.
constexpr std::uint32_t kMostWords = 40;
/// Only W15 has rules of its own; modulo and bit-reversed pointers are interpreted.
constexpr std::uint16_t kPlainPointers = 0x8000;

struct Blocks {
    using Machine = dspic::Machine;
    using Op = dspic::Op;

    static Cycle& cycle(Machine& m) { return m.st.cycle; }
    static bool may_enter(const Machine& m) { return m.special == kPlainPointers; }
    static std::uint32_t block_at(Machine& m, std::uint32_t index) {
        Translated& t = m.translated;
        if (t.entries[index] == 0 && m.code[index].run == &decode_now) return 0;
        return t.block_at(index, [&] { return translate::block_at(*t.library, m, index); });
    }
    static chip::Left enter(Machine& m, std::uint32_t block) {
        return translate::enter(*m.translated.library, m, block);
    }
    static const Op* execute(Machine& m, const Op* op) {
        m.current = op;
        return m.stops_at(op) ? nullptr : execute_one(m, op);
    }
};

}  // namespace

void run_translated(Machine& m) {
    if (!m.translated.library && !m.translated.prepare(translate::library_for(m), m.code_words))
        return run_interpreted(m);
    note_rate(m);
    chip::run_blocks<Blocks>(m);
    m.st.cycle += std::exchange(m.late, 0);
}

void forget_blocks(Machine& m, std::uint32_t index) {
    m.translated.forget(index, kMostWords);
}

void forget_all_blocks(Machine& m) {
    m.translated.forget_all();
}

}  // namespace puckloop::dspic
