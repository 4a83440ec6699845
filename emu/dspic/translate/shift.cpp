// One operand: counting, complements, shifts and rotations by one bit; shifts by many bits; extensions.

#include "emu/dspic/translate/emitter.h"

namespace puckloop::dspic::translate {

using namespace Xbyak::util;
using From = Flags::From;

/// Of eax (r8d and r9d for sums) into the register returned.
Xbyak::Reg32 Emitter::apply(One one, bool byte_size) {
    const int top = byte_size ? 7 : 15;
    const std::uint32_t ones = byte_size ? 0xFF : 0xFFFF;
    /// The bit of eax that is shifted out goes to esi, where C is from then on.
    const auto shift_out = [&](int bit) {
        mov(esi, eax);
        if (bit > 0) shr(esi, bit);
        and_(esi, 1);
        flags_.c = From::Bit;
    };
    switch (one) {
    case One::Inc:
        add_constant(1, 0, byte_size);
        return r10d;
    case One::Inc2:
        add_constant(2, 0, byte_size);
        return r10d;
    case One::Dec:
        add_constant(~1u, 1, byte_size);
        return r10d;
    case One::Dec2:
        add_constant(~2u, 1, byte_size);
        return r10d;
    case One::Neg:
        xor_(r9d, ones);
        xor_(r8d, r8d);
        lea(r10d, ptr[r8 + r9 + 1]);
        set_sum(byte_size, 1, false);
        return r10d;
    case One::Clear:
        xor_(eax, eax);
        return eax;
    case One::Set:
        mov(eax, ones);
        return eax;
    case One::Com:
        xor_(eax, ones);
        mov(r11d, eax);
        break;
    case One::Sl:
        shift_out(top);
        add(eax, eax);
        and_(eax, ones);
        mov(r11d, eax);
        break;
    case One::Lsr:
        shift_out(0);
        shr(eax, 1);
        mov(r11d, eax);
        break;
    case One::Asr:
        shift_out(0);
        byte_size ? movsx(eax, al) : movsx(eax, ax);
        sar(eax, 1);
        and_(eax, ones);
        mov(r11d, eax);
        break;
    case One::Rlnc:
        mov(r11d, eax);
        shr(r11d, top);
        lea(r11d, ptr[r11 + rax * 2]);
        and_(r11d, ones);
        break;
    case One::Rlc:
        carry_to(r11d);
        shift_out(top);
        lea(r11d, ptr[r11 + rax * 2]);
        and_(r11d, ones);
        break;
    case One::Rrnc:
        mov(r11d, eax);
        and_(r11d, 1);
        shl(r11d, top);
        shr(eax, 1);
        or_(r11d, eax);
        break;
    case One::Rrc:
        carry_to(r11d);
        shift_out(0);
        shl(r11d, top);
        shr(eax, 1);
        or_(r11d, eax);
        break;
    }
    set_result(byte_size);
    return r11d;
}

bool Emitter::emit_shift(const Op* op) {
    switch (op->form) {
    case FormId::SL_Wb_lit4_Wnd:
    case FormId::LSR_Wb_lit4_Wnd:
    case FormId::ASR_Wb_lit4_Wnd:
        break;
    case FormId::SL_Wb_Wns_Wnd:
    case FormId::LSR_Wb_Wns_Wnd:
    case FormId::ASR_Wb_Wns_Wnd:
        load_w(ecx, op->s, false);
        and_(ecx, 31);
        break;
    case FormId::SE_Ws_Wnd:
    case FormId::ZE_Ws_Wnd: {
        const bool is_signed = op->form == FormId::SE_Ws_Wnd;
        if (op->source == Ea::Indirect) read_index(op, true);
        load_source(op, r11d, true);
        move_source(op, true);
        if (is_signed) {
            movsx(r11d, r11b);
            movzx(r11d, r11w);
        }
        mov(esi, r11d);
        shr(esi, 15);
        xor_(esi, 1);
        flags_.c = From::Bit;
        set_result(false);
        store_w(op->d, r11d, false);
        return true;
    }
    case FormId::SWAP_Wn:
        load_w(eax, op->s, false);
        op->byte ? rol(al, 4) : rol(ax, 8);
        store_w(op->s, eax, op->byte);
        return true;
    case FormId::EXCH_Wns_Wnd:
        load_w(ecx, op->s, false);
        load_w(edx, op->d, false);
        store_w(op->s, edx, false);
        store_w(op->d, ecx, false);
        return true;
    default:
        return false;
    }
    const bool literal = form(op->form).has_field('k');
    const bool left = op->form == FormId::SL_Wb_lit4_Wnd || op->form == FormId::SL_Wb_Wns_Wnd;
    const bool arithmetic = op->form == FormId::ASR_Wb_lit4_Wnd || op->form == FormId::ASR_Wb_Wns_Wnd;
    if (arithmetic)
        movsx(r11d, w_word(op->b));
    else
        load_w(r11d, op->b, false);
    if (left)
        literal ? shl(r11d, op->k) : shl(r11d, cl);
    else if (arithmetic)
        literal ? sar(r11d, op->k) : sar(r11d, cl);
    else
        literal ? shr(r11d, op->k) : shr(r11d, cl);
    if (left || arithmetic) movzx(r11d, r11w);
    set_result(false);
    store_w(op->d, r11d, false);
    return true;
}

bool Emitter::emit_multiply(const Op* op) {
    bool signed_b = false, signed_s = false;
    switch (op->form) {
    case FormId::MUL_SS_Wb_Ws_Wnd:
        signed_b = signed_s = true;
        break;
    case FormId::MUL_SU_Wb_lit5_Wnd:
    case FormId::MUL_SU_Wb_Ws_Wnd:
        signed_b = true;
        break;
    case FormId::MUL_US_Wb_Ws_Wnd:
        signed_s = true;
        break;
    case FormId::MUL_UU_Wb_lit5_Wnd:
    case FormId::MUL_UU_Wb_Ws_Wnd:
        break;
    default:
        return false;
    }
    if (op->source == Ea::Indirect) read_index(op, false);
    load_source(op, edx, false);
    if (signed_s) movsx(edx, dx);
    if (signed_b)
        movsx(eax, w_word(op->b));
    else
        load_w(eax, op->b, false);
    move_source(op, false);
    imul(eax, edx);
    mov(w_double(op->d), eax);
    return true;
}

}  // namespace puckloop::dspic::translate
