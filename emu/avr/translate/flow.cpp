// Branches, skips, jumps, calls and returns, and the arrival at a loop's branch (fast/idle_loops.cpp).

#include "emu/avr/translate/emitter.h"

namespace puckloop::avr::translate {

using namespace Xbyak::util;

/// As decode.cpp has it.
bool Emitter::arrives(std::uint32_t target) const {
    return target <= index_ && index_ - target < kLongestLoop;
}

/// Counts down the loop's wait; leaves before the branch when it is over.
void Emitter::arrive(const Op*, std::uint32_t target) {
    if (!arrives(target)) return;
    Xbyak::Label done, waits;
    const int wait = static_cast<int>(index_ * sizeof(LoopInfo) + offsetof(LoopInfo, wait));
    cmp(byte[r12 + layout_.skip_idle], 0);
    je(done);
    mov(rax, qword[r12 + layout_.loops]);
    cmp(word[rax + wait], 0);
    jne(waits);
    account(cycles_, steps_);
    leave_before(index_, chip::Left::Slow);
    L(waits);
    dec(word[rax + wait]);
    L(done);
}

void Emitter::taken(const Op* op, std::uint32_t target, std::uint32_t extra_cycles) {
    flush();
    if (op->form == FormId::BRBS || op->form == FormId::BRBC || op->form == FormId::RJMP) arrive(op, target);
    account(cycles_ + op->cycles + extra_cycles, steps_ + 1);
    go_to(target);
}

void Emitter::branch(const Op* op) {
    Xbyak::Label away;
    const bool if_set = op->form == FormId::BRBS;
    const auto jump = [&](auto when_set, auto when_clear) {
        if_set ? (this->*when_set)(away, T_NEAR) : (this->*when_clear)(away, T_NEAR);
    };
    using Jump = void (Xbyak::CodeGenerator::*)(const Xbyak::Label&, LabelType);
    const bool here = pending_.mask & op->b;
    const std::uint8_t b = op->b;
    if (here && b == sreg::Z && pending_.chain) {
        Xbyak::Label clear, over;
        mov(ecx, r11d);
        jecxz(clear);
        if_set ? jmp(away, T_NEAR) : jmp(over);
        L(clear);
        if (!if_set) jmp(away, T_NEAR);
        L(over);
    } else if (here && b == sreg::Z) {
        jump(Jump(&Emitter::je), Jump(&Emitter::jne));
    } else if (here && (b == sreg::C || (b == sreg::S && pending_.shift))) {
        jump(Jump(&Emitter::jb), Jump(&Emitter::jae));
    } else if (here && b == sreg::N) {
        jump(Jump(&Emitter::js), Jump(&Emitter::jns));
    } else if (here && b == sreg::S) {
        jump(Jump(&Emitter::jl), Jump(&Emitter::jge));
    } else if (here && b == sreg::V && !pending_.shift) {
        jump(Jump(&Emitter::jo), Jump(&Emitter::jno));
    } else {
        flush();
        test(sreg_byte(), b);
        jump(Jump(&Emitter::jne), Jump(&Emitter::je));
    }
    cold(away, [this, op] { taken(op, op->k, 1); });
}

void Emitter::skip(const Op* op, bool when_zero) {
    Xbyak::Label over;
    when_zero ? je(over, T_NEAR) : jne(over, T_NEAR);
    cold(over, [this, op] { taken(op, index_ + op->skip, op->skip - 1u); });
}

void Emitter::emit_call(const Op* op, std::uint32_t words) {
    const auto sp = word[r12 + layout_.sp];
    movzx(eax, sp);
    check_ram();
    lea(eax, ptr[rax - 1]);
    check_ram();
    const std::uint32_t back = index_ + words;
    mov(byte[r13 + rax + 1], static_cast<std::uint8_t>(back));
    mov(byte[r13 + rax], static_cast<std::uint8_t>(back >> 8));
    lea(eax, ptr[rax - 1]);
    mov(sp, ax);
    if (op->form == FormId::ICALL) movzx(esi, pair_of(kZ));
}

void Emitter::emit_return(const Op*) {
    const auto sp = word[r12 + layout_.sp];
    movzx(eax, sp);
    lea(eax, ptr[rax + 1]);
    check_ram();
    lea(eax, ptr[rax + 1]);
    check_ram();
    movzx(edx, byte[r13 + rax]);      // low
    movzx(esi, byte[r13 + rax - 1]);  // high
    mov(sp, ax);
}

Emitter::Flow Emitter::emit_flow(const Op* op) {
    const auto away = [&] {  // to the program word in esi
        flush();
        account(cycles_ + op->cycles, steps_ + 1);
        mov(ecx, esi);
        go_to_ecx();
        return Flow::Ended;
    };
    using enum FormId;
    switch (op->form) {
    case BRBS:
    case BRBC:
        branch(op);
        return Flow::Next;
    case RJMP:
    case JMP:
        taken(op, op->k, 0);
        return Flow::Ended;
    case IJMP:
        movzx(esi, pair_of(kZ));
        return away();
    case CALL:
    case RCALL:
        emit_call(op, op->form == CALL ? 2 : 1);
        taken(op, op->k, 0);
        return Flow::Ended;
    case ICALL:
        emit_call(op, 1);
        return away();
    case RET:
        emit_return(op);
        flush();
        shl(esi, 8);
        or_(esi, edx);
        return away();
    case CPSE:
        flush();
        mov(al, reg(op->d));
        cmp(al, reg(op->r));
        skip(op, true);
        return Flow::Next;
    case SBRC:
    case SBRS:
        flush();
        test(reg(op->r), op->b);
        skip(op, op->form == SBRC);
        return Flow::Next;
    default:
        return Flow::Unknown;
    }
}

}  // namespace puckloop::avr::translate
