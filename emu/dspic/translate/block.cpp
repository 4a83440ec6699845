// A block: operations one after the other from an entry on, with ways out at taken branches, up to the first
// one that is not translated. What is fixed for it is computed here once: cycles, stalls, pointers that
// must have been written, and which of them it writes.

#include "emu/dspic/translate/emitter.h"

namespace puckloop::dspic::translate {

using namespace Xbyak::util;

namespace {

/// To be replaced: an immediate of four bytes.
constexpr std::uint32_t kPatched = 0x7FFFFFFF;
constexpr std::uint32_t kPointers = 0xFFFF0000;

}  // namespace

Emitter::Emitter(const Layout& layout, std::uint8_t* where, std::size_t room, std::size_t offset)
    : BlockEmitter({.base = Xbyak::util::rbp,
                    .count = Xbyak::util::r13,
                    .cycle = layout.cycle,
                    .limit = layout.limit,
                    .instructions = layout.instructions,
                    .code = layout.code,
                    .current = layout.current,
                    .entries = layout.entries,
                    .operation_bytes = sizeof(Op),
                    .program_words = layout.code_words},
                   where, room, offset),
      layout_(layout) {
    words_ = 1 + kLookedAt;
}

void Emitter::load_registers() {
    mov(r14d, dword[rbp + layout_.watch]);
    mov(r12, qword[rbp + layout_.ram]);
}

void Emitter::store_registers() {
    mov(dword[rbp + layout_.watch], r14d);
}

bool Emitter::emit_block(Machine& m, std::uint32_t index, const Shared& shared) {
    machine_ = &m;
    if (!emit_operations(index, shared)) return false;
    rewrite(needs_at_, needs_, sizeof needs_);
    words_ = index_ - start_ + kLookedAt;
    return true;
}

void Emitter::emit_head(Xbyak::Label& late) {
    test(r14d, kPatched);
    needs_at_ = getSize() - sizeof(std::uint32_t);
    jnz(late, T_NEAR);
}

Emitter::Flow Emitter::emit_next() {
    if (index_ >= layout_.code_words) return Flow::Unknown;
    const Op* op = machine_->code + index_;
    // What was never executed is not translated either: nobody is to find it decoded too early.
    if (op->marks || op->run == &decode_now) return Flow::Unknown;
    stall_ = op->uses & writes_ & ~kPointers ? 1 : 0;
    const std::uint32_t uses = (steps_ == 0 ? op->uses : op->uses & kPointers) & keep_;
    const Flow flow = emit(op);
    if (flow != Flow::Unknown) needs_ |= uses;
    return flow;
}

void Emitter::settle() {
    flush_flags();
    account(cycles_, steps_, keep_, writes_);
}

std::function<void()> Emitter::point() {
    return [this, flags = flags_, cycles = cycles_, steps = steps_, index = index_, keep = keep_,
            writes = writes_, stall = stall_] {
        flags_ = flags;
        cycles_ = cycles;
        steps_ = steps;
        index_ = index;
        keep_ = keep;
        writes_ = writes;
        stall_ = stall;
    };
}

Emitter::Flow Emitter::emit(const Op* op) {
    const Flow flow = emit_flow(op);
    if (flow != Flow::Unknown) return flow;
    if (!emit_clear_flag(op) && !emit_recipe(op)) return Flow::Unknown;
    finish_step(op);
    return Flow::Next;
}

void Emitter::finish_step(const Op* op) {
    finish_bail();
    ++index_;
    ++steps_;
    cycles_ += op->cycles + stall_;
    keep_ &= op->keep;
    writes_ = op->writes;
}

void Emitter::account(std::uint32_t cycles, std::uint32_t steps, std::uint32_t keep, std::uint32_t writes) {
    if (steps == 0) return;
    BlockEmitter::account(cycles, steps);
    and_(r14d, keep);
    if (writes) or_(r14d, writes);
}

}  // namespace puckloop::dspic::translate
