// Where the flags are, and how SREG gets them.

#include "emu/avr/machine/alu.h"
#include "emu/avr/translate/emitter.h"

#include <cstddef>

namespace puckloop::avr::translate {

using namespace Xbyak::util;

void Emitter::set_pending(std::uint8_t mask, bool shift, bool chain) {
    pending_ = {mask, shift, chain};
}

void Emitter::flush() {
    if (pending_.mask == 0) return;
    lahf();
    if (pending_.shift) {
        movzx(eax, ah);
        movzx(eax, byte[rbp + rax + static_cast<int>(offsetof(Layout::Tables, shift_flags))]);
    } else {
        seto(al);
        xchg(al, ah);
        movzx(eax, ax);
        movzx(eax, byte[rbp + rax + static_cast<int>(offsetof(Layout::Tables, flags))]);
    }
    if (pending_.chain) {
        and_(eax, static_cast<std::uint8_t>(~sreg::Z));
        lea(eax, ptr[rax + r11 * 2]);
    }
    if (pending_.mask != kHsvnzc) and_(eax, pending_.mask);
    movzx(ecx, sreg_byte());
    and_(ecx, static_cast<std::uint8_t>(~pending_.mask));
    or_(eax, ecx);
    mov(sreg_byte(), al);
    pending_ = {};
}

void Emitter::lose_flags(std::uint8_t written) {
    if (pending_.mask & live_ & ~written) flush();
    pending_ = {};
}

/// An operation that takes the carry, and Z if `chained`; it sets all flags of a sum.
void Emitter::with_carry(const Op*, bool chained, const std::function<void()>& operation) {
    const bool chain = chained && (live_ & sreg::Z);
    if (!(pending_.mask & sreg::C) || (chain && !(pending_.mask & sreg::Z))) {
        flush();
        if (chain) {
            movzx(r11d, sreg_byte());
            shr(r11d, 1);
            and_(r11d, 1);
        }
        bt(dword[r12 + layout_.sreg], 0);
    } else if (chain && !pending_.chain) {
        mov(r11d, 0);
        sete(r11b);
    }
    operation();
    if (chain) cmovne(r11d, r10d);
    set_pending(kHsvnzc, false, chain);
}

FlagUse flag_use(const Op& op, std::uint8_t live, const Layout& layout) {
    using enum FormId;
    constexpr std::uint8_t kAll = 0xFF;
    const auto chained = static_cast<std::uint8_t>(sreg::C | (live & sreg::Z));
    switch (op.form) {
    case ADD:
    case SUB:
    case SUBI:
    case NEG:
    case CP:
    case CPI:
        return {0, kHsvnzc};
    case ADC:
        return {sreg::C, kHsvnzc};
    case SBC:
    case SBCI:
    case CPC:
        return {chained, kHsvnzc};
    case AND:
    case ANDI:
    case OR:
    case ORI:
    case EOR:
    case INC:
    case DEC:
        return {0, kSvnz};
    case COM:
    case LSR:
    case ASR:
    case ADIW:
    case SBIW:
        return {0, kSvnzc};
    case ROR:
        return {sreg::C, kSvnzc};
    case MUL:
    case MULS:
    case MULSU:
        return {0, sreg::Z | sreg::C};
    case BST:
        return {0, sreg::T};
    case BLD:
        return {sreg::T, 0};
    case MOV:
    case MOVW:
    case LDI:
    case SWAP:
    case NOP:
        return {0, 0};
    case LDS:
    case STS:
        if (op.k - layout.ram_start < layout.ram_bytes) return {0, 0};
        break;
    default:
        break;
    }
    return {kAll, 0};  // a way out
}

}  // namespace puckloop::avr::translate
