#include "emu/dspic/fast/service_shortcut.h"

#include "emu/dspic/fast/loop_undo.h"
#include "emu/dspic/fast/service_walk.h"

namespace puckloop::dspic {

using Word = ServiceShortcut::Word;

const ServiceShortcut* service_shortcut(Machine& m, int vector) {
    if (vector < kTrapVectors) return nullptr;
    auto& known = m.shortcuts.known;
    const auto index = static_cast<std::size_t>(vector);
    if (known.size() <= index) known.resize(index + 1);
    const std::uint32_t table = m.irq.alternate_table() ? m.device.aivt : m.device.ivt;
    const std::uint32_t handler = m.program[table / 2 + index] & kProgramSpace;
    if (known[index] && known[index]->handler == handler)
        return known[index]->possible ? &*known[index] : nullptr;
    if (handler / 2 >= m.code_words) return nullptr;
    ServiceShortcut fresh;
    fresh.handler = handler;
    switch (ServiceWalk(m, fresh, vector - kTrapVectors).run(m.code + handler / 2)) {
    case ServiceWalk::End::NotYet:
        return nullptr;
    case ServiceWalk::End::Done:
        fresh.possible = true;
        break;
    case ServiceWalk::End::Never:
        break;
    }
    m.loop_undo->note_shortcut(index, known[index]);
    known[index] = fresh;
    return fresh.possible ? &*known[index] : nullptr;
}

bool stack_holds(const Machine& m, const ServiceShortcut& shortcut, std::uint16_t stack) {
    const auto lowest = static_cast<std::uint16_t>(stack - kRamStart);
    return lowest + shortcut.depth <= m.stack_span && lowest / 2 + shortcut.depth / 2 <= m.ram_words;
}

bool refreshes_hold(const Machine& m, const ServiceShortcut& shortcut) {
    for (std::size_t i = 0; i < shortcut.refresh_count; ++i)
        if (m.sfr.raw(shortcut.refreshes[i].address) != shortcut.refreshes[i].value) return false;
    return true;
}

void push_trace(Machine& m, const ServiceShortcut& shortcut, const Interrupted& interrupted) {
    const std::uint16_t stack = interrupted.w[15];
    std::uint16_t* const words = m.ram + (stack - kRamStart) / 2;
    for (std::size_t i = 0; i < shortcut.push_count; ++i) {
        const ServiceShortcut::Push& push = shortcut.pushes[i];
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
