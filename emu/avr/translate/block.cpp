// A block: operations one after the other from an entry on, with ways out at taken branches, up to the first
// one that is not translated.

#include "emu/avr/translate/emitter.h"

#include <algorithm>

namespace puckloop::avr::translate {

using namespace Xbyak::util;

Emitter::Emitter(const Layout& layout, std::uint8_t* where, std::size_t room, std::size_t offset)
    : BlockEmitter({.base = Xbyak::util::r12,
                    .count = Xbyak::util::r14,
                    .cycle = layout.cycle,
                    .limit = layout.limit,
                    .instructions = layout.instructions,
                    .code = layout.code,
                    .current = layout.current,
                    .entries = layout.entries,
                    .operation_bytes = sizeof(Op),
                    .program_words = layout.flash_words},
                   where, room, offset),
      layout_(layout) {}

void Emitter::load_registers() {
    lea(r13, ptr[r12 + layout_.data]);
    mov(rbp, reinterpret_cast<std::uint64_t>(&layout_.tables));
    xor_(r10d, r10d);
}

/// The operations in a row, and which flags are read behind each.
void Emitter::gather(Machine& m, std::uint32_t index) {
    const std::uint32_t first = index;
    std::uint32_t cycles = 0;
    while (plan_.size() < kMostOperations && cycles < kMostCycles) {
        if (index + 2 > layout_.flash_words) break;
        Op& op = m.code_store[index];
        if (op.run == &decode_now) decode(m, op);
        const auto length = static_cast<std::uint32_t>(length_of(m.program[index]));
        // A skip looks at the word behind it.
        words_ = std::max(words_, index + length + (op.skip ? 1 : 0) - first);
        if (op.form == FormId::Undefined || index == 0) break;  // somebody looks at arrivals at 0
        plan_.push_back({&op, length, 0});
        cycles += op.cycles;
        index += length;
        if (form(op.form).extra == Extra::None && (op.form == FormId::RJMP || op.form == FormId::JMP)) break;
    }
    std::uint8_t live = 0xFF;
    for (auto step = plan_.rbegin(); step != plan_.rend(); ++step) {
        step->live = live;
        const FlagUse use = flag_use(*step->op, live, layout_);
        live = static_cast<std::uint8_t>((live & ~use.writes) | use.reads);
    }
}

bool Emitter::emit_block(Machine& m, std::uint32_t index, const Shared& shared) {
    gather(m, index);
    return emit_operations(index, shared);
}

Emitter::Flow Emitter::emit_next() {
    const Step& step = plan_[steps_];
    live_ = step.live;
    const Flow flow = emit(step.op);
    if (flow == Flow::Unknown) return flow;
    finish_bail();
    ++steps_;
    cycles_ += step.op->cycles;
    index_ += step.words;
    return flow;
}

void Emitter::settle() {
    flush();
    account(cycles_, steps_);
}

std::function<void()> Emitter::point() {
    return [this, pending = pending_, cycles = cycles_, steps = steps_, index = index_] {
        pending_ = pending;
        cycles_ = cycles;
        steps_ = steps;
        index_ = index;
    };
}

Emitter::Flow Emitter::emit(const Op* op) {
    const Flow flow = emit_flow(op);
    if (flow != Flow::Unknown) return flow;
    if (emit_alu(op) || emit_memory(op) || emit_shift(op) || emit_bits(op) || emit_multiply(op))
        return Flow::Next;
    return Flow::Unknown;
}

}  // namespace puckloop::avr::translate
