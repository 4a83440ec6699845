#include "emu/dspic/translate/emitter.h"

namespace puckloop::dspic::translate {

using namespace Xbyak::util;
using From = Flags::From;

namespace {

// Host conditions: the low four bits of a jump's opcode; an odd one is the opposite of the one before.
constexpr int kBelow = 2, kEqual = 4, kNotEqual = 5, kBelowOrEqual = 6, kAbove = 7, kSign = 8,
              kLessOrEqual = 14;

/// For a test of C, Z, OV and N as SR holds them: bit n = the outcome for SR<3:0> = n.
std::uint32_t outcomes(Test test) {
    std::uint32_t table = 0;
    for (std::uint32_t s = 0; s < 16; ++s) {
        const bool c = s & sr::C, z = s & sr::Z, ov = s & sr::OV, n = s & sr::N;
        bool holds = false;
        switch (test) {
        case Test::Overflow:
            holds = ov;
            break;
        case Test::Carry:
            holds = c;
            break;
        case Test::Zero:
            holds = z;
            break;
        case Test::Negative:
            holds = n;
            break;
        case Test::Less:
            holds = n != ov;
            break;
        case Test::LessOrEqual:
            holds = z || n != ov;
            break;
        case Test::NotAbove:
            holds = !c || z;
            break;
        }
        table |= (holds ? 1u : 0u) << s;
    }
    return table;
}

}  // namespace

void Emitter::set_sum(bool byte_size, int carry, bool sticky) {
    flags_ = {From::Sum, sticky ? From::Sticky : From::Sum, From::Sum, From::Sum, From::Sum};
    flags_.sum_byte = byte_size;
    flags_.carry = carry;
}

void Emitter::set_result(bool byte_size) {
    flags_.z = flags_.n = From::Result;
    flags_.result_byte = byte_size;
}

void Emitter::flush_flags() {
    if (flags_.all_in_sr()) return;
    std::uint32_t mask = 0;
    bool any = false;
    const int shift = flags_.sum_byte ? 8 : 16;
    /// Adds what ecx holds to eax.
    const auto merge = [&](std::uint32_t flag) {
        any ? or_(eax, ecx) : mov(eax, ecx);
        any = true;
        mask |= flag;
    };
    if (flags_.ov == From::Sum) {
        mov(ecx, r8d);
        mov(edx, r9d);
        xor_(ecx, r10d);
        xor_(edx, r10d);
        and_(ecx, edx);
        shr(ecx, shift - 3);
        and_(ecx, sr::OV);
        merge(sr::OV);
    }
    if (flags_.dc == From::Sum) {
        mov(ecx, r8d);
        xor_(ecx, r9d);
        xor_(ecx, r10d);
        if (flags_.sum_byte) shl(ecx, 4);
        and_(ecx, sr::DC);
        merge(sr::DC);
    }
    if (flags_.n == From::Sum || flags_.n == From::Result) {
        const bool sum = flags_.n == From::Sum;
        mov(ecx, sum ? r10d : r11d);
        shr(ecx, (sum ? flags_.sum_byte : flags_.result_byte) ? 4 : 12);
        and_(ecx, sr::N);
        merge(sr::N);
    }
    if (flags_.c == From::Sum) {
        mov(ecx, r10d);
        shr(ecx, shift);
        merge(sr::C);
    } else if (flags_.c == From::Bit) {
        mov(ecx, esi);
        merge(sr::C);
    }
    if (flags_.z != From::Sr) {
        xor_(ecx, ecx);
        if (flags_.z == From::Result)
            test(r11d, r11d);
        else if (flags_.sum_byte)
            test(r10b, r10b);
        else
            test(r10w, r10w);
        sete(cl);
        add(ecx, ecx);
        if (flags_.z == From::Sticky) and_(cx, word[rbp + layout_.sr]);
        merge(sr::Z);
    }
    movzx(ecx, word[rbp + layout_.sr]);
    and_(ecx, ~mask & 0xFFFF);
    or_(ecx, eax);
    mov(word[rbp + layout_.sr], cx);
    flags_ = {};
}

void Emitter::carry_to(const Xbyak::Reg32& reg) {
    switch (flags_.c) {
    case From::Sum:
        mov(reg, r10d);
        shr(reg, flags_.sum_byte ? 8 : 16);
        break;
    case From::Bit:
        mov(reg, esi);
        break;
    default:
        movzx(reg, byte[rbp + layout_.sr]);
        and_(reg, 1);
        break;
    }
}

int Emitter::condition(Test which) {
    const bool sum_z = flags_.z == From::Sum, sum_c = flags_.c == From::Sum;
    const bool signed_sum = flags_.n == From::Sum && flags_.ov == From::Sum && flags_.carry >= 0;
    const auto test_sum = [this] { flags_.sum_byte ? test(r10b, r10b) : test(r10w, r10w); };
    const std::uint32_t full = flags_.sum_byte ? 0x100 : 0x10000;
    if (which == Test::Zero && sum_z) {
        test_sum();
        return kEqual;
    }
    if (which == Test::Zero && flags_.z == From::Result) {
        test(r11d, r11d);
        return kEqual;
    }
    if (which == Test::Carry && sum_c) {
        cmp(r10d, full - 1);
        return kAbove;
    }
    if (which == Test::Carry && flags_.c == From::Bit) {
        test(esi, esi);
        return kNotEqual;
    }
    if (which == Test::Negative && flags_.n == From::Sum) {
        test_sum();
        return kSign;
    }
    if (which == Test::Negative && flags_.n == From::Result) {
        flags_.result_byte ? test(r11b, r11b) : test(r11w, r11w);
        return kSign;
    }
    if (which == Test::NotAbove && sum_z && sum_c) {
        cmp(r10d, full);
        return kBelowOrEqual;
    }
    // The sum of the signed operands, exact: N differs from OV if it is negative.
    if ((which == Test::Less || (which == Test::LessOrEqual && sum_z)) && signed_sum) {
        if (flags_.sum_byte) {
            movsx(eax, r8b);
            movsx(ecx, r9b);
        } else {
            movsx(eax, r8w);
            movsx(ecx, r9w);
        }
        lea(eax, ptr[rax + rcx + flags_.carry]);
        test(eax, eax);
        return which == Test::Less ? kSign : kLessOrEqual;
    }
    flush_flags();
    movzx(eax, word[rbp + layout_.sr]);
    and_(eax, 15);
    mov(ecx, outcomes(which));
    bt(ecx, eax);
    return kBelow;
}

void Emitter::jump_if(int host_condition, Xbyak::Label& label) {
    using Jump = void (Xbyak::CodeGenerator::*)(const Xbyak::Label&, LabelType);
    static constexpr Jump kJumps[16] = {
        &Emitter::jo,  &Emitter::jno, &Emitter::jb,  &Emitter::jae, &Emitter::je, &Emitter::jne,
        &Emitter::jbe, &Emitter::ja,  &Emitter::js,  &Emitter::jns, &Emitter::jp, &Emitter::jnp,
        &Emitter::jl,  &Emitter::jge, &Emitter::jle, &Emitter::jg,
    };
    (this->*kJumps[host_condition])(label, T_NEAR);
}

}  // namespace puckloop::dspic::translate
