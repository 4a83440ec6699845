// Special-function registers: reads that are a look at the stored word and nothing else (SfrSpace::Plain),
// the core's own registers that compilers save, and an interrupt's flag cleared by its routine. Everything
// else is left to the interpreter.

#include "emu/dspic/devices/dspic30f6014a_sfr.h"
#include "emu/dspic/translate/emitter.h"

#include <cstddef>

namespace puckloop::dspic::translate {

using namespace Xbyak::util;
using Plain = SfrSpace::Plain;

namespace {

constexpr int kValue = static_cast<int>(offsetof(Plain, value));
constexpr int kKind = static_cast<int>(offsetof(Plain, kind));
constexpr int kUntil = static_cast<int>(offsetof(Plain, until));
constexpr int kFirstLevel = static_cast<int>(offsetof(InterruptController::Line, first.level));
constexpr int kResting = static_cast<int>(offsetof(InterruptController::Line, resting));
constexpr int kHighestUserLevel = 7;

}  // namespace

/// rax: SfrSpace::Plain, rdx: the register's word. Out if a read of it is more than a look, now. Uses both.
void Emitter::jump_unless_plain(Xbyak::Label& out, std::uint32_t cycles) {
    movzx(edx, byte[rax + rdx + kKind]);
    mov(rdx, qword[rax + rdx * 8 + kUntil]);
    lea(rax, ptr[rbx + static_cast<int>(cycles)]);
    cmp(rax, rdx);
    jae(out, T_NEAR);
}

void Emitter::readable_index(int disp, bool byte_size) {
    Xbyak::Label elsewhere, back;
    lea(ecx, ptr[rax + disp - kRamStart]);
    if (byte_size) {
        cmp(ecx, layout_.ram_words * 2);
    } else {
        ror(ecx, 1);  // an odd address becomes an index out of range
        cmp(ecx, layout_.ram_words);
    }
    jae(elsewhere, T_NEAR);
    L(back);
    // To a register the index leads all the same: backwards from RAM.
    cold(elsewhere, [this, disp, byte_size, back] {
        Xbyak::Label out;
        lea(ecx, ptr[rax + disp]);
        movzx(ecx, cx);
        if (!byte_size) {
            test(cl, 1);
            jnz(out, T_NEAR);
        }
        cmp(ecx, kRamStart);
        jae(out, T_NEAR);
        mov(edx, ecx);
        shr(edx, 1);
        mov(rax, qword[rbp + layout_.plain]);
        jump_unless_plain(out, cycles_);
        mov(rax, qword[rbp + layout_.plain]);
        lea(rcx, ptr[rax + rcx + kValue]);
        sub(rcx, r12);
        if (!byte_size) sar(rcx, 1);
        jmp(back, T_NEAR);
        L(out);
        leave_unchanged();
    });
}

bool Emitter::can_read_plain(std::uint32_t address, bool byte_size) const {
    return address < kRamStart && (byte_size || address % 2 == 0) &&
           machine_->plain->kind[address / 2] != Plain::kNever;
}

void Emitter::check_plain(std::uint32_t address) {
    mov(rax, qword[rbp + layout_.plain]);
    mov(edx, address / 2);
    jump_unless_plain(bail(), cycles_);
    mov(rcx, qword[rbp + layout_.plain]);
}

Xbyak::Address Emitter::plain_cell(std::uint32_t address, bool byte_size) {
    const int at = kValue + static_cast<int>(address);
    return byte_size ? byte[rcx + at] : word[rcx + at];
}

std::optional<Emitter::CoreRegister> Emitter::core_register(std::uint32_t address) const {
    switch (address) {
    case sfr::RCOUNT:
        return CoreRegister{layout_.rcount, 0x3FFF};
    case sfr::PSVPAG:
        return CoreRegister{layout_.psvpag, 0xFF};
    default:
        return std::nullopt;
    }
}

/// A flag is cleared, and after it no source is both flagged and enabled: nobody is in line any more.
bool Emitter::emit_clear_flag(const Op* op) {
    const int at = op->k & ~1;
    if (op->form != FormId::BCLR_f_bit4 || at < layout_.ifs || at >= layout_.ifs + 2 * layout_.ifs_words)
        return false;
    const auto mask = static_cast<std::uint16_t>(~(op->aux << (op->k & 1 ? 8 : 0)));
    mov(rax, qword[rbp + layout_.line]);
    cmp(word[rax + (kResting + at - layout_.ifs)], 0);
    jne(bail(), T_NEAR);
    cmp(dword[rax + kFirstLevel], kHighestUserLevel);
    ja(bail(), T_NEAR);
    mov(rcx, qword[rbp + layout_.plain]);
    for (int i = 0; i < layout_.ifs_words; ++i) {
        const int flags = layout_.ifs + 2 * i;
        movzx(edx, word[rcx + kValue + flags]);
        if (flags == at) and_(edx, mask);
        test(word[rcx + (kValue + layout_.iec + 2 * i)], dx);
        jnz(bail(), T_NEAR);
    }
    mov(edx, mask);
    and_(word[rcx + (kValue + at)], dx);
    mov(qword[rax + static_cast<int>(offsetof(InterruptController::Line, first))], 0);
    mov(byte[rbp + layout_.eligible], 0);
    mov(byte[rbp + layout_.disi_waits], 0);
    return true;
}

}  // namespace puckloop::dspic::translate
