// A block: operations one after the other from an entry on, with ways out at taken branches, up to the first
// one that is not translated. What is fixed for it is computed here once: cycles, stalls, pointers that
// must have been written, and which of them it writes.

#include "emu/dspic/translate/emitter.h"

namespace puckloop::dspic::translate {

using namespace Xbyak::util;

namespace {

/// To be replaced: an immediate or displacement of four bytes.
constexpr std::uint32_t kPatched = 0x7FFFFFFF;
constexpr std::uint32_t kPointers = 0xFFFF0000;

}  // namespace

Emitter::Emitter(const Layout& layout, std::uint8_t* where, std::size_t room, std::size_t offset)
    : Xbyak::CodeGenerator(room, where), layout_(layout), offset_(offset) {}

Emitter::Shared Emitter::emit_entry_code() {
    Shared shared;
    Xbyak::Label leave;
    shared.no_entry = static_cast<std::uint32_t>(getSize());
    mov(eax, static_cast<int>(Left::NoEntry));
    jmp(leave, T_NEAR);

    align(16);
    shared.enter = static_cast<std::uint32_t>(getSize());  // (state, start of all code, offset of the block)
    for (const auto& reg : {rbx, rbp, r12, r13, r14, r15})
        push(reg);
    mov(rbp, rdi);
    mov(rdi, rsi);
    mov(rbx, qword[rbp + layout_.cycle]);
    mov(r13, qword[rbp + layout_.instructions]);
    mov(r14d, dword[rbp + layout_.watch]);
    mov(r12, qword[rbp + layout_.ram]);
    mov(r15, qword[rbp + layout_.entries]);
    mov(eax, edx);
    add(rax, rdi);
    jmp(rax);

    align(16);
    shared.leave = static_cast<std::uint32_t>(getSize());  // ecx: program word, eax: why
    L(leave);
    mov(qword[rbp + layout_.cycle], rbx);
    mov(qword[rbp + layout_.instructions], r13);
    mov(dword[rbp + layout_.watch], r14d);
    imul(rcx, rcx, sizeof(Op));
    add(rcx, qword[rbp + layout_.code]);
    mov(qword[rbp + layout_.current], rcx);
    for (const auto& reg : {r15, r14, r13, r12, rbp, rbx})
        pop(reg);
    ret();

    align(16);
    shared.arrival = static_cast<std::uint32_t>(getSize());
    emit_arrival();
    return shared;
}

bool Emitter::emit_block(Machine& m, std::uint32_t index, const Shared& shared) {
    shared_ = shared;
    machine_ = &m;
    start_ = index_ = index;
    Xbyak::Label late;
    L(entry_);
    lea(rax, ptr[rbx + static_cast<int>(kPatched)]);
    const std::size_t last_start_at = getSize() - sizeof(std::uint32_t);
    cmp(rax, qword[rbp + layout_.limit]);
    jae(late, T_NEAR);
    test(r14d, kPatched);
    const std::size_t needs_at = getSize() - sizeof(std::uint32_t);
    jnz(late, T_NEAR);

    std::uint32_t needs = 0;
    std::uint32_t last_start = 0;
    Flow flow = Flow::Next;
    while (flow == Flow::Next && steps_ < kMostOperations && cycles_ < kMostCycles) {
        if (index_ >= layout_.code_words) {
            flow = Flow::Unknown;
            break;
        }
        const Op* op = m.code + index_;
        stall_ = op->uses & writes_ & ~kPointers ? 1 : 0;
        const std::uint32_t uses = (steps_ == 0 ? op->uses : op->uses & kPointers) & keep_;
        const std::uint32_t start = cycles_;
        bailed_ = false;
        bail_.clear();
        // What was never executed is not translated either: nobody is to find it decoded too early.
        flow = op->marks || op->run == &decode_now ? Flow::Unknown : emit(m, op);
        if (flow == Flow::Unknown) break;
        needs |= uses;
        last_start = start;
    }
    if (steps_ == 0) return false;
    if (flow != Flow::Ended) {
        flush_flags();
        account(cycles_, steps_, keep_, writes_);
        if (flow == Flow::Unknown)
            leave_before(index_, Left::Slow);
        else
            go_to(index_);
    }
    const auto patch = [this](std::size_t at, std::uint32_t value) { rewrite(at, value, 4); };
    patch(last_start_at, last_start);
    patch(needs_at, needs);
    for (std::size_t i = 0; i < cold_.size(); ++i) {
        L(cold_[i].label);
        cold_[i].emit();
    }
    L(late);
    leave_before(start_, Left::Limit);
    words_ = index_ - start_ + kLookedAt;
    return true;
}

Emitter::Flow Emitter::emit(Machine& m, const Op* op) {
    const Flow flow = emit_flow(m, op);
    if (flow != Flow::Unknown) return flow;
    if (!emit_alu(op) && !emit_move(op) && !emit_shift(op) && !emit_bits(op) && !emit_multiply(op))
        return Flow::Unknown;
    finish_step(op);
    return Flow::Next;
}

Xbyak::Label& Emitter::bail() {
    if (!bailed_) bail_flags_ = flags_;
    bailed_ = true;
    return bail_;
}

std::function<void()> Emitter::leaving(const Flags& flags) {
    return [this, flags, cycles = cycles_, steps = steps_, keep = keep_, writes = writes_, index = index_] {
        flags_ = flags;
        flush_flags();
        account(cycles, steps, keep, writes);
        leave_before(index, Left::Slow);
    };
}

void Emitter::finish_bail() {
    if (!bailed_) return;
    cold(bail_, leaving(bail_flags_));
    bailed_ = false;
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
    add(rbx, cycles);
    add(r13, steps);
    and_(r14d, keep);
    if (writes) or_(r14d, writes);
}

const void* Emitter::at_start(std::uint32_t offset) {
    return getCode() - offset_ + offset;
}

void Emitter::leave_before(std::uint32_t index, Left why) {
    mov(ecx, index);
    mov(eax, static_cast<int>(why));
    jmp(at_start(shared_.leave), T_NEAR);
}

void Emitter::go_to(std::uint32_t index) {
    if (index == start_) return jmp(entry_, T_NEAR);
    mov(ecx, index);
    mov(eax, dword[r15 + static_cast<int>(index * sizeof(std::uint32_t))]);
    add(rax, rdi);
    jmp(rax);
}

}  // namespace puckloop::dspic::translate
