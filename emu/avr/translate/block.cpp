// A block: operations one after the other from an entry on, with ways out at taken branches, up to the first
// one that is not translated.

#include "emu/avr/translate/emitter.h"

#include <algorithm>

namespace puckloop::avr::translate {

using namespace Xbyak::util;

namespace {

/// To be replaced: a displacement of four bytes.
constexpr std::uint32_t kPatched = 0x7FFFFFFF;

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
    shared.enter =
        static_cast<std::uint32_t>(getSize());  // (machine, start of all code, offset of the block)
    for (const auto& reg64 : {rbx, rbp, r12, r13, r14, r15})
        push(reg64);
    mov(r12, rdi);
    mov(rdi, rsi);
    lea(r13, ptr[r12 + layout_.data]);
    mov(rbx, qword[r12 + layout_.cycle]);
    mov(r14, qword[r12 + layout_.instructions]);
    mov(r15, qword[r12 + layout_.entries]);
    mov(rbp, reinterpret_cast<std::uint64_t>(&layout_.tables));
    xor_(r10d, r10d);
    mov(eax, edx);
    add(rax, rdi);
    jmp(rax);

    align(16);
    shared.leave = static_cast<std::uint32_t>(getSize());  // ecx: program word, eax: why
    L(leave);
    mov(qword[r12 + layout_.cycle], rbx);
    mov(qword[r12 + layout_.instructions], r14);
    imul(rcx, rcx, sizeof(Op));
    add(rcx, qword[r12 + layout_.code]);
    mov(qword[r12 + layout_.current], rcx);
    for (const auto& reg64 : {r15, r14, r13, r12, rbp, rbx})
        pop(reg64);
    ret();
    return shared;
}

/// The operations in a row, and which flags are read behind each.
void Emitter::gather(Machine& m, std::uint32_t index) {
    std::uint32_t cycles = 0;
    words_ = 1;
    while (plan_.size() < kMostOperations && cycles < kMostCycles) {
        if (index + 2 > layout_.flash_words) break;
        Op& op = m.code_store[index];
        if (op.run == &decode_now) decode(m, op);
        const auto length = static_cast<std::uint32_t>(length_of(m.program[index]));
        // A skip looks at the word behind it.
        words_ = std::max(words_, index + length + (op.skip ? 1 : 0) - start_);
        if (op.form == FormId::Undefined || index == 0) break;  // somebody looks at arrivals at 0
        plan_.push_back({&op, index, 0});
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
    shared_ = shared;
    start_ = index_ = index;
    gather(m, index);
    Xbyak::Label late;
    L(entry_);
    lea(rax, ptr[rbx + static_cast<int>(kPatched)]);
    const std::size_t last_start_at = getSize() - sizeof(std::uint32_t);
    cmp(rax, qword[r12 + layout_.limit]);
    jae(late, T_NEAR);
    std::uint32_t last_start = 0;
    Flow flow = Flow::Next;
    for (const Step& step : plan_) {
        index_ = step.index;
        live_ = step.live;
        const std::uint32_t start = cycles_;
        bailed_ = false;
        bail_.clear();
        flow = emit(step);
        if (flow == Flow::Unknown) break;
        finish_bail();
        last_start = start;
        ++steps_;
        cycles_ += step.op->cycles;
        index_ += static_cast<std::uint32_t>(length_of(m.program[step.index]));
        if (flow == Flow::Ended) break;
    }
    if (steps_ == 0) return false;
    if (flow != Flow::Ended) {
        flush();
        account(cycles_, steps_);
        if (flow == Flow::Unknown || index_ >= layout_.flash_words)
            leave_before(index_, Left::Slow);
        else
            go_to(index_);
    }
    rewrite(last_start_at, last_start, sizeof last_start);
    for (std::size_t i = 0; i < cold_.size(); ++i) {
        L(cold_[i].label);
        cold_[i].emit();
    }
    L(late);
    leave_before(start_, Left::Limit);
    return true;
}

Emitter::Flow Emitter::emit(const Step& step) {
    const Flow flow = emit_flow(step.op);
    if (flow != Flow::Unknown) return flow;
    if (emit_alu(step.op) || emit_memory(step.op) || emit_shift(step.op) || emit_bits(step.op) ||
        emit_multiply(step.op))
        return Flow::Next;
    return Flow::Unknown;
}

void Emitter::cold(Xbyak::Label& label, std::function<void()> emit) {
    cold_.push_back({label, [this, pending = pending_, cycles = cycles_, steps = steps_, index = index_,
                             emit = std::move(emit)] {
                         pending_ = pending;
                         cycles_ = cycles;
                         steps_ = steps;
                         index_ = index;
                         emit();
                     }});
}

Xbyak::Label& Emitter::bail() {
    if (!bailed_) bail_pending_ = pending_;
    bailed_ = true;
    return bail_;
}

void Emitter::finish_bail() {
    if (!bailed_) return;
    cold(bail_, [this, pending = bail_pending_] {
        pending_ = pending;
        flush();
        account(cycles_, steps_);
        leave_before(index_, Left::Slow);
    });
    bailed_ = false;
}

void Emitter::account(std::uint32_t cycles, std::uint32_t steps) {
    if (steps == 0) return;
    add(rbx, cycles);
    add(r14, steps);
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

}  // namespace puckloop::avr::translate
