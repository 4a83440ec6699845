#include "emu/dspic/translate/translation.h"

#include "emu/dspic/machine/interpret.h"
#include "emu/dspic/machine/machine.h"
#include "emu/dspic/translate/library.h"
#include "emu/dspic/waits/wait_watch.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace puckloop::dspic {

namespace {

constexpr std::uint8_t kNever = 255;
/// No block rests on more program words.
constexpr std::uint32_t kMostWords = 40;
/// Only W15 has rules of its own; modulo and bit-reversed pointers are interpreted.
constexpr std::uint16_t kPlainPointers = 0x8000;

/// False: the host cannot, and this machine does not ask again.
bool prepare(Machine& m) {
    Translated& t = m.translated;
    t.library = translate::library_for(m);
    if (t.library) {
        t.entries = static_cast<std::uint32_t*>(std::calloc(m.code_words, sizeof *t.entries));
        t.heat = static_cast<std::uint8_t*>(std::calloc(m.code_words, sizeof *t.heat));
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
    if (m.code[index].run == &decode_now) return 0;
    std::uint8_t& heat = t.heat[index];
    if (heat == kNever || ++heat < t.hot) return 0;
    t.entries[index] = translate::block_at(*t.library, m, index);
    heat = kNever;
    return t.entries[index];
}

}  // namespace

void run_translated(Machine& m) {
    if (!m.translated.library && !prepare(m)) return run_interpreted(m);
    note_rate(m);
    const Op* op = m.current;
    bool at_head = true;  // a block may begin here
    do {
        bool resumes = false;
        if (at_head && m.special == kPlainPointers) {
            const auto index = static_cast<std::uint32_t>(op - m.code);
            if (const std::uint32_t block = index < m.code_words ? block_at(m, index) : 0) {
                const translate::Left left = translate::enter(*m.translated.library, m, block);
                op = m.current;
                if (left == translate::Left::NoEntry) continue;
                if (m.st.cycle >= m.limit) break;
                resumes = left == translate::Left::Slow;
            } else {
                resumes = index < m.code_words && m.translated.heat[index] == kNever;
            }
        }
        m.current = op;
        if (m.stops_at(op)) break;
        const Op* const next = execute_one(m, op);
        at_head = resumes || next != op + 1;
        op = next;
    } while (m.st.cycle < m.limit);
    m.current = op;
    m.st.cycle += std::exchange(m.late, 0);
}

void forget_blocks(Machine& m, std::uint32_t index) {
    Translated& t = m.translated;
    if (!t.library || index >= m.code_words) return;
    const std::uint32_t first = index < kMostWords ? 0 : index - kMostWords;
    std::fill(t.entries + first, t.entries + index + 1, 0);
    std::fill(t.heat + first, t.heat + index + 1, std::uint8_t{0});
}

void forget_all_blocks(Machine& m) {
    Translated& t = m.translated;
    std::free(std::exchange(t.entries, nullptr));
    std::free(std::exchange(t.heat, nullptr));
    t.library = nullptr;
}

}  // namespace puckloop::dspic
