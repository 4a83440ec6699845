#include "emu/avr/translate/translation.h"

#include "emu/avr/machine/machine.h"
#include "emu/avr/translate/library.h"

#include <algorithm>
#include <cstdlib>

namespace puckloop::avr {

namespace {

constexpr std::uint8_t kNever = 255;

/// False: the host cannot, and this core does not ask again.
bool prepare(Machine& m) {
    Translated& t = m.translated;
    t.library = translate::library_for(m);
    if (t.library) {
        t.entries = static_cast<std::uint32_t*>(std::calloc(m.device.flash_words, sizeof *t.entries));
        t.heat = static_cast<std::uint8_t*>(std::calloc(m.device.flash_words, sizeof *t.heat));
    }
    if (t.library && t.entries && t.heat) return true;
    t.library = nullptr;
    t.on = false;
    return false;
}

/// The block at this word, if there is one or it is time to make it.
std::uint32_t block_at(Machine& m, std::uint32_t index) {
    Translated& t = m.translated;
    if (t.entries[index] != 0) return t.entries[index];
    std::uint8_t& heat = t.heat[index];
    if (heat == kNever || ++heat < t.hot) return 0;
    t.entries[index] = translate::block_at(*t.library, m, index);
    heat = kNever;
    return t.entries[index];
}

}  // namespace

bool run_translated(Machine& m) {
    if (!m.translated.library && !prepare(m)) return false;
    const Op* op = m.current;
    bool at_head = true;  // a block may begin here
    do {
        bool resumes = false;
        if (at_head) {
            const auto index = static_cast<std::uint32_t>(op - m.code);
            if (const std::uint32_t block = index < m.device.flash_words ? block_at(m, index) : 0) {
                const translate::Left left = translate::enter(*m.translated.library, m, block);
                op = m.current;
                if (left == translate::Left::NoEntry) continue;
                if (m.cycle >= m.limit) break;
                resumes = left == translate::Left::Slow;
            }
        }
        const Op* const next = op->run(m, op);
        m.cycle += op->cycles;
        ++m.instructions;
        at_head = resumes || next != op + 1;
        op = next;
    } while (m.cycle < m.limit);
    m.current = op;
    return true;
}

void forget_blocks(Machine& m, std::uint32_t index) {
    Translated& t = m.translated;
    if (!t.library || index >= m.device.flash_words) return;
    const std::uint32_t first = index < translate::kMostWords ? 0 : index - translate::kMostWords;
    std::fill(t.entries + first, t.entries + index + 1, 0);
    std::fill(t.heat + first, t.heat + index + 1, std::uint8_t{0});
}

}  // namespace puckloop::avr
