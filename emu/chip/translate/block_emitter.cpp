#include "emu/chip/translate/block_emitter.h"

#include <utility>

namespace puckloop::chip {

using namespace Xbyak::util;

namespace {

/// To be replaced: a displacement of four bytes.
constexpr std::uint32_t kPatched = 0x7FFFFFFF;

}  // namespace

BlockEmitter::BlockEmitter(const Frame& frame, std::uint8_t* where, std::size_t room, std::size_t offset)
    : Xbyak::CodeGenerator(room, where), frame_(frame), offset_(offset) {}

BlockEmitter::Shared BlockEmitter::emit_entry_code() {
    const auto& base = frame_.base;
    Shared shared;
    Xbyak::Label leave;
    shared.no_entry = static_cast<std::uint32_t>(getSize());
    mov(eax, static_cast<int>(Left::NoEntry));
    jmp(leave, T_NEAR);

    align(16);
    shared.enter = static_cast<std::uint32_t>(getSize());  // (base, start of all code, offset of the block)
    for (const auto& saved : {rbx, rbp, r12, r13, r14, r15})
        push(saved);
    mov(base, rdi);
    mov(rdi, rsi);
    mov(rbx, qword[base + frame_.cycle]);
    mov(frame_.count, qword[base + frame_.instructions]);
    mov(r15, qword[base + frame_.entries]);
    load_registers();
    mov(eax, edx);
    add(rax, rdi);
    jmp(rax);

    align(16);
    shared.leave = static_cast<std::uint32_t>(getSize());  // ecx: program word, eax: why
    L(leave);
    mov(qword[base + frame_.cycle], rbx);
    mov(qword[base + frame_.instructions], frame_.count);
    store_registers();
    imul(rcx, rcx, static_cast<int>(frame_.operation_bytes));
    add(rcx, qword[base + frame_.code]);
    mov(qword[base + frame_.current], rcx);
    for (const auto& saved : {r15, r14, r13, r12, rbp, rbx})
        pop(saved);
    ret();

    align(16);
    shared.own = static_cast<std::uint32_t>(getSize());
    emit_own();
    return shared;
}

bool BlockEmitter::emit_operations(std::uint32_t index, const Shared& shared) {
    shared_ = shared;
    start_ = index_ = index;
    Xbyak::Label late;
    L(entry_);
    lea(rax, ptr[rbx + static_cast<int>(kPatched)]);
    const std::size_t last_start_at = getSize() - sizeof(std::uint32_t);
    cmp(rax, qword[frame_.base + frame_.limit]);
    jae(late, T_NEAR);
    emit_head(late);
    std::uint32_t last_start = 0;
    Flow flow = Flow::Next;
    while (flow == Flow::Next && goes_on()) {
        const std::uint32_t start = cycles_;
        bailed_ = false;
        bail_.clear();
        flow = emit_next();
        if (flow != Flow::Unknown) last_start = start;
    }
    if (steps_ == 0) return false;
    if (flow != Flow::Ended) {
        settle();
        if (flow == Flow::Unknown || index_ >= frame_.program_words)
            leave_before(index_, Left::Slow);
        else
            go_to(index_);
    }
    rewrite(last_start_at, last_start, sizeof last_start);
    const std::uint32_t end = index_;
    for (std::size_t i = 0; i < cold_.size(); ++i) {
        L(cold_[i].label);
        cold_[i].emit();
    }
    index_ = end;
    L(late);
    leave_before(start_, Left::Limit);
    return true;
}

Xbyak::Label& BlockEmitter::bail() {
    if (!bailed_) bail_point_ = point();
    bailed_ = true;
    return bail_;
}

void BlockEmitter::finish_bail() {
    if (!bailed_) return;
    cold_.push_back({bail_, [this, restore = std::move(bail_point_)] {
                         restore();
                         leave_unchanged();
                     }});
    bailed_ = false;
}

void BlockEmitter::cold(const Xbyak::Label& label, std::function<void()> emit) {
    cold_.push_back({label, [restore = point(), emit = std::move(emit)] {
                         restore();
                         emit();
                     }});
}

void BlockEmitter::leave_unchanged() {
    settle();
    leave_before(index_, Left::Slow);
}

void BlockEmitter::leave_before(std::uint32_t index, Left why) {
    mov(ecx, index);
    mov(eax, static_cast<int>(why));
    jmp(at_start(shared_.leave), T_NEAR);
}

void BlockEmitter::go_to(std::uint32_t index) {
    if (index == start_) return jmp(entry_, T_NEAR);
    mov(ecx, index);
    mov(eax, dword[r15 + static_cast<int>(index * sizeof(std::uint32_t))]);
    add(rax, rdi);
    jmp(rax);
}

void BlockEmitter::go_to_ecx() {
    mov(eax, dword[r15 + rcx * sizeof(std::uint32_t)]);
    add(rax, rdi);
    jmp(rax);
}

void BlockEmitter::account(std::uint32_t cycles, std::uint32_t steps) {
    if (steps == 0) return;
    add(rbx, cycles);
    add(frame_.count, steps);
}

const void* BlockEmitter::at_start(std::uint32_t offset) {
    return getCode() - offset_ + offset;
}

}  // namespace puckloop::chip
