// Loads and stores in RAM, the stack, and SREG as a register. Everything else outside RAM leaves the block.

#include "emu/avr/translate/emitter.h"

namespace puckloop::avr::translate {

using namespace Xbyak::util;

namespace {
constexpr std::uint16_t kSreg = 0x5F;
}

/// By the upper byte alone; an address that wrapped, or went beyond 16 bits, has that of a register.
void Emitter::check_ram() {
    Xbyak::Label inside;
    movzx(ecx, ah);
    movzx(ecx, byte[rbp + rcx + static_cast<int>(offsetof(Layout::Tables, not_ram))]);
    jecxz(inside);
    jmp(bail(), T_NEAR);
    L(inside);
}

bool Emitter::access_of(const Op* op, Access& access, bool& loads) {
    using enum FormId;
    loads = true;
    switch (op->form) {
        // clang-format off
    case ST_X: loads = false; [[fallthrough]];
    case LD_X: access = {kX, 0, 0, 0}; return true;
    case ST_X_INC: loads = false; [[fallthrough]];
    case LD_X_INC: access = {kX, 0, 1, 0}; return true;
    case ST_X_DEC: loads = false; [[fallthrough]];
    case LD_X_DEC: access = {kX, -1, 0, 0}; return true;
    case ST_Y_INC: loads = false; [[fallthrough]];
    case LD_Y_INC: access = {kY, 0, 1, 0}; return true;
    case ST_Y_DEC: loads = false; [[fallthrough]];
    case LD_Y_DEC: access = {kY, -1, 0, 0}; return true;
    case STD_Y: loads = false; [[fallthrough]];
    case LDD_Y: access = {kY, 0, 0, op->k}; return true;
    case ST_Z_INC: loads = false; [[fallthrough]];
    case LD_Z_INC: access = {kZ, 0, 1, 0}; return true;
    case ST_Z_DEC: loads = false; [[fallthrough]];
    case LD_Z_DEC: access = {kZ, -1, 0, 0}; return true;
    case STD_Z: loads = false; [[fallthrough]];
    case LDD_Z: access = {kZ, 0, 0, op->k}; return true;
        // clang-format on
    default:
        return false;
    }
}

bool Emitter::emit_memory(const Op* op) {
    const auto sp = word[r12 + layout_.sp];
    switch (op->form) {
    case FormId::LDS:
        if (!is_ram(op->k)) return false;
        mov(al, byte[r13 + static_cast<int>(op->k)]);
        mov(reg(op->d), al);
        return true;
    case FormId::STS:
        if (!is_ram(op->k)) return false;
        mov(al, reg(op->r));
        mov(byte[r13 + static_cast<int>(op->k)], al);
        return true;
    case FormId::PUSH:
        movzx(eax, sp);
        check_ram();
        mov(dl, reg(op->r));
        mov(byte[r13 + rax], dl);
        lea(eax, ptr[rax - 1]);
        mov(sp, ax);
        return true;
    case FormId::POP:
        movzx(eax, sp);
        lea(eax, ptr[rax + 1]);
        check_ram();
        mov(dl, byte[r13 + rax]);
        mov(sp, ax);
        mov(reg(op->d), dl);
        return true;
    case FormId::IN:
        if (op->k != kSreg) return false;
        flush();
        mov(al, sreg_byte());
        mov(reg(op->d), al);
        lea(rax, ptr[rbx + static_cast<int>(cycles_ + op->cycles - 1)]);
        mov(qword[r12 + layout_.now], rax);
        return true;
    default:
        break;
    }
    Access access;
    bool loads = false;
    if (!access_of(op, access, loads)) return false;
    movzx(eax, pair_of(access.pointer));
    if (const int add = access.before + access.displacement) lea(eax, ptr[rax + add]);
    check_ram();
    if (loads)
        mov(dl, byte[r13 + rax]);
    else
        mov(dl, reg(op->r));
    if (access.before) mov(pair_of(access.pointer), ax);
    if (access.after) {
        lea(ecx, ptr[rax + 1]);
        mov(pair_of(access.pointer), cx);
    }
    if (loads)
        mov(reg(op->d), dl);
    else
        mov(byte[r13 + rax], dl);
    return true;
}

}  // namespace puckloop::avr::translate
