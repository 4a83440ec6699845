#include "emu/dspic/fast/isr_summary.h"

#include "emu/dspic/fast/idle_loops.h"
#include "emu/dspic/fast/known_services.h"
#include "emu/dspic/fast/loop_undo.h"
#include "emu/dspic/fast/symbolic_isr.h"

namespace puckloop::dspic {

using Word = IsrSummary::Word;

const IsrSummary* isr_summary(Machine& m, int vector) {
    if (vector < kTrapVectors) return nullptr;
    auto& known = m.services->summaries;
    const auto index = static_cast<std::size_t>(vector);
    if (known.size() <= index) known.resize(index + 1);
    const std::uint32_t table = m.irq.alternate_table() ? m.device.aivt : m.device.ivt;
    const std::uint32_t handler = m.program[table / 2 + index] & kProgramSpace;
    if (known[index] && known[index]->handler == handler)
        return known[index]->possible ? &*known[index] : nullptr;
    if (handler / 2 >= m.code_words) return nullptr;
    ++m.skip->work.summary_walks;
    IsrSummary fresh;
    fresh.handler = handler;
    switch (SymbolicIsr(m, fresh, vector - kTrapVectors).run(m.code + handler / 2)) {
    case SymbolicIsr::End::NotYet:
        return nullptr;
    case SymbolicIsr::End::Done:
        fresh.possible = true;
        break;
    case SymbolicIsr::End::Never:
        break;
    }
    m.loop_undo->note_isr_summary(index, known[index]);
    known[index] = fresh;
    return fresh.possible ? &*known[index] : nullptr;
}

bool stack_holds(const Machine& m, std::uint16_t depth, std::uint16_t stack) {
    const auto lowest = static_cast<std::uint16_t>(stack - kRamStart);
    return lowest + depth <= m.stack_span && lowest / 2 + depth / 2 <= m.ram_words;
}

bool refreshes_hold(const Machine& m, const IsrSummary& summary) {
    for (std::size_t i = 0; i < summary.refresh_count; ++i)
        if (m.sfr.raw(summary.refreshes[i].address) != summary.refreshes[i].value) return false;
    return true;
}

void push_trace(Machine& m, const IsrSummary& summary, const Interrupted& interrupted) {
    const std::uint16_t stack = interrupted.w[15];
    std::uint16_t* const words = m.ram + (stack - kRamStart) / 2;
    for (std::size_t i = 0; i < summary.push_count; ++i) {
        const IsrSummary::Push& push = summary.pushes[i];
        std::uint32_t value = push.value;
        switch (push.kind) {
        case Word::Register:
            value = interrupted.w[push.value];
            break;
        case Word::Constant:
            break;
        case Word::StackOffset:
            value = stack + push.value;
            break;
        case Word::ReturnLow:
            value = stacked_pc_low(interrupted.pc);
            break;
        case Word::ReturnHigh:
            value = stacked_status(interrupted.sr, m.st.corcon, interrupted.pc);
            break;
        }
        words[push.offset / 2] = static_cast<std::uint16_t>(value);
    }
}

}  // namespace puckloop::dspic
