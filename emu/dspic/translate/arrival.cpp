// What happens at a taken backward branch (idle_loops.h, wait_watch.h), as far as it is the same as last
// time.

#include "emu/dspic/translate/emitter.h"

#include <cstddef>

namespace puckloop::dspic::translate {

using namespace Xbyak::util;

/// rcx: the branch, r8: its program word, rdx: the cycle of the arrival. Carry set: not as last time, the
/// interpreter does it. Uses rax, rdx and rsi: SR is whole when it is called.
void Emitter::emit_arrival() {
    static const WaitWatch::Stay stay;
    const auto of_stay = [](const auto& field) {
        return static_cast<int>(reinterpret_cast<const char*>(&field) - reinterpret_cast<const char*>(&stay));
    };
    Xbyak::Label noted, slow, inside, done, other;
    cmp(byte[rcx + static_cast<int>(offsetof(Op, may_skip))], 0);
    je(done, T_NEAR);
    // note_arrival(), as long as the stay neither ends nor is to be looked at.
    test(byte[rbp + layout_.corcon], corcon::IPL3);
    jnz(slow, T_NEAR);
    movzx(eax, byte[rbp + layout_.sr]);
    shr(eax, sr::kIplShift);
    cmp(eax, dword[rbp + layout_.wait_level]);
    jne(slow, T_NEAR);
    imul(eax, eax, sizeof(WaitWatch::Stay));
    lea(rax, ptr[rbp + rax + layout_.stays]);
    cmp(rcx, qword[rax + of_stay(stay.branch)]);
    jne(other, T_NEAR);
    cmp(rdx, qword[rax + of_stay(stay.next_look)]);
    jae(slow, T_NEAR);
    mov(qword[rax + of_stay(stay.last)], rdx);
    L(noted);
    // try_skip(), as long as it has to wait.
    cmp(byte[rbp + layout_.skip_idle], 0);
    je(done, T_NEAR);
    mov(rax, qword[rbp + layout_.loop_index]);
    test(rax, rax);
    jz(slow, T_NEAR);
    movzx(eax, word[rax + r8 * 2]);
    sub(eax, 1);
    jb(slow, T_NEAR);
    mov(rsi, qword[rbp + layout_.loop_waits]);
    movzx(edx, word[rsi + rax * 2]);
    sub(edx, 1);
    jb(slow, T_NEAR);
    mov(word[rsi + rax * 2], dx);
    L(done);
    clc();
    ret();
    L(other);  // a loop within the one that is stayed in, or in what it calls
    cmp(qword[rax + of_stay(stay.branch)], 0);
    je(slow, T_NEAR);
    movzx(esi, w_word(15));
    cmp(si, word[rax + of_stay(stay.stack)]);
    ja(inside, T_NEAR);
    cmp(rcx, qword[rax + of_stay(stay.head)]);
    jb(slow, T_NEAR);
    cmp(rcx, qword[rax + of_stay(stay.branch)]);
    ja(slow, T_NEAR);
    L(inside);
    sub(rdx, qword[rax + of_stay(stay.last)]);
    cmp(rdx, qword[rbp + layout_.stale_after]);
    jb(noted, T_NEAR);
    L(slow);
    stc();
    ret();
}

void Emitter::arrive(std::uint32_t extra_cycles) {
    mov(rcx, qword[rbp + layout_.code]);
    add(rcx, static_cast<std::uint32_t>(index_ * sizeof(Op)));
    mov(r8d, index_);
    lea(rdx, ptr[rbx + static_cast<int>(cycles_ + extra_cycles)]);
    call(at_start(shared_.own));
    jc(bail(), T_NEAR);
}

}  // namespace puckloop::dspic::translate
