// Adding, subtracting, logic, shifting, multiplying, single bits: on working registers in memory.

#include "emu/avr/machine/alu.h"
#include "emu/avr/translate/emitter.h"

namespace puckloop::avr::translate {

using namespace Xbyak::util;

bool Emitter::emit_alu(const Op* op) {
    const auto d = reg(op->d), r = reg(op->r);
    const auto k = static_cast<std::uint8_t>(op->k);
    const auto sums = [&](std::uint8_t mask, const auto& operation) {
        lose_flags(mask);
        operation();
        set_pending(mask);
        return true;
    };
    const auto logic = [&](const auto& operation) { return sums(kSvnz, operation); };
    using enum FormId;
    switch (op->form) {
        // clang-format off
    case ADD: return sums(kHsvnzc, [&] { mov(al, r); add(d, al); });
    case SUB: return sums(kHsvnzc, [&] { mov(al, r); sub(d, al); });
    case SUBI: return sums(kHsvnzc, [&] { sub(d, k); });
    case NEG: return sums(kHsvnzc, [&] { neg(d); });
    case CP: return sums(kHsvnzc, [&] { mov(al, d); cmp(al, r); });
    case CPI: return sums(kHsvnzc, [&] { cmp(d, k); });
    case ADC: with_carry(op, false, [&] { mov(al, r); adc(d, al); }); return true;
    case SBC: with_carry(op, true, [&] { mov(al, r); sbb(d, al); }); return true;
    case SBCI: with_carry(op, true, [&] { sbb(d, k); }); return true;
    case CPC: with_carry(op, true, [&] { mov(al, d); sbb(al, r); }); return true;
    case ADIW: return sums(kSvnzc, [&] { add(pair_of(op->d), op->k); });
    case SBIW: return sums(kSvnzc, [&] { sub(pair_of(op->d), op->k); });
    case INC: return logic([&] { inc(d); });
    case DEC: return logic([&] { dec(d); });
    case AND: return logic([&] { mov(al, r); and_(d, al); });
    case ANDI: return logic([&] { and_(d, k); });
    case OR: return logic([&] { mov(al, r); or_(d, al); });
    case ORI: return logic([&] { or_(d, k); });
    case EOR: return logic([&] { mov(al, r); xor_(d, al); });
    case COM: return sums(kSvnzc, [&] { xor_(d, 0xFF); stc(); });
    case MOV: mov(al, r); mov(d, al); return true;
    case MOVW: mov(ax, pair_of(op->r)); mov(pair_of(op->d), ax); return true;
    case LDI: mov(d, k); return true;
    case NOP: return true;
        // clang-format on
    default:
        return false;
    }
}

bool Emitter::emit_shift(const Op* op) {
    const auto d = reg(op->d);
    switch (op->form) {
    case FormId::LSR:
    case FormId::ASR:
        lose_flags(kSvnzc);
        op->form == FormId::LSR ? shr(d, 1) : sar(d, 1);
        set_pending(kSvnzc, true);
        return true;
    case FormId::ROR: {
        const bool fresh = pending_.mask & sreg::C;
        if (!fresh || (pending_.mask & live_ & ~kSvnzc)) {
            flush();
            bt(dword[r12 + layout_.sreg], 0);
        }
        pending_ = {};
        rcr(d, 1);
        constexpr std::uint8_t kOthers = kSvnzc & ~sreg::C;
        if (!(live_ & kOthers)) {  // the host's rotation leaves its other flags
            set_pending(sreg::C);
            return true;
        }
        setc(cl);
        mov(dl, d);
        test(dl, dl);
        lahf();
        movzx(eax, ah);
        or_(al, cl);
        movzx(eax, byte[rbp + rax + static_cast<int>(offsetof(Layout::Tables, shift_flags))]);
        and_(eax, kSvnzc);
        movzx(ecx, sreg_byte());
        and_(ecx, static_cast<std::uint8_t>(~kSvnzc));
        or_(eax, ecx);
        mov(sreg_byte(), al);
        return true;
    }
    case FormId::SWAP:
        lose_flags();
        rol(d, 4);
        return true;
    default:
        return false;
    }
}

bool Emitter::emit_multiply(const Op* op) {
    const auto d = reg(op->d), r = reg(op->r);
    if (op->form != FormId::MUL && op->form != FormId::MULS && op->form != FormId::MULSU) return false;
    lose_flags(sreg::Z | sreg::C);
    op->form == FormId::MUL ? movzx(eax, d) : movsx(eax, d);
    op->form == FormId::MULS ? movsx(ecx, r) : movzx(ecx, r);
    imul(eax, ecx);
    mov(pair_of(0), ax);
    if (!(live_ & (sreg::Z | sreg::C))) return true;
    xor_(ecx, ecx);
    test(ax, ax);
    sete(cl);
    add(ecx, ecx);
    shr(eax, 15);
    and_(eax, 1);
    or_(eax, ecx);
    movzx(ecx, sreg_byte());
    and_(ecx, static_cast<std::uint8_t>(~(sreg::Z | sreg::C)));
    or_(eax, ecx);
    mov(sreg_byte(), al);
    return true;
}

bool Emitter::emit_bits(const Op* op) {
    const auto d = reg(op->d);
    switch (op->form) {
    case FormId::BST:
        lose_flags(sreg::T);
        xor_(eax, eax);
        test(d, op->b);
        setne(al);
        shl(eax, 6);
        movzx(ecx, sreg_byte());
        and_(ecx, static_cast<std::uint8_t>(~sreg::T));
        or_(eax, ecx);
        mov(sreg_byte(), al);
        return true;
    case FormId::BLD: {
        Xbyak::Label clear;
        lose_flags();
        movzx(eax, d);
        and_(eax, static_cast<std::uint8_t>(~op->b));
        test(sreg_byte(), sreg::T);
        jz(clear);
        or_(eax, op->b);
        L(clear);
        mov(d, al);
        return true;
    }
    case FormId::BCLR:
        flush();
        and_(sreg_byte(), static_cast<std::uint8_t>(~op->b));
        return true;
    case FormId::BSET:
        if (op->b & sreg::I) return false;
        flush();
        or_(sreg_byte(), op->b);
        return true;
    default:
        return false;
    }
}

}  // namespace puckloop::avr::translate
