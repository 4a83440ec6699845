#include "emu/avr/translate/translation.h"

#include "emu/avr/machine/machine.h"
#include "emu/avr/translate/library.h"
#include "emu/chip/translate/run_blocks.h"

namespace puckloop::avr {

namespace {

struct Blocks {
    using Machine = avr::Machine;
    using Op = avr::Op;

    static Cycle& cycle(Machine& m) { return m.cycle; }
    static bool may_enter(const Machine&) { return true; }
    static std::uint32_t block_at(Machine& m, std::uint32_t index) {
        Translated& t = m.translated;
        return t.block_at(index, [&] { return translate::block_at(*t.library, m, index); });
    }
    static chip::Left enter(Machine& m, std::uint32_t block) {
        return translate::enter(*m.translated.library, m, block);
    }
    static const Op* execute(Machine& m, const Op* op) {
        const Op* const next = op->run(m, op);
        m.cycle += op->cycles;
        ++m.instructions;
        return next;
    }
};

}  // namespace

bool run_translated(Machine& m) {
    Translated& t = m.translated;
    if (!t.library && !t.prepare(translate::library_for(m), m.device.flash_words)) return false;
    chip::run_blocks<Blocks>(m);
    return true;
}

void forget_blocks(Machine& m, std::uint32_t index) {
    m.translated.forget(index, translate::kMostWords);
}

}  // namespace puckloop::avr
