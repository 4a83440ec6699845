// Single bits: set, clear, toggle, test.

#include "emu/dspic/translate/emitter.h"

#include <bit>

namespace puckloop::dspic::translate {

using namespace Xbyak::util;
using From = Flags::From;

bool Emitter::emit_bits(const Op* op) {
    const auto change = [&](std::uint32_t mask) {
        switch (op->form) {
        case FormId::BSET_Ws_bit4:
        case FormId::BSET_f_bit4:
            or_(eax, mask);
            break;
        case FormId::BCLR_Ws_bit4:
        case FormId::BCLR_f_bit4:
            and_(eax, ~mask);
            break;
        default:
            xor_(eax, mask);
            break;
        }
    };
    switch (op->form) {
    case FormId::BSET_Ws_bit4:
    case FormId::BCLR_Ws_bit4:
    case FormId::BTG_Ws_bit4:
        if (op->source == Ea::Direct) {
            load_w(eax, op->s, false);
            change(op->k);
            store_w(op->s, eax, op->byte);
            return true;
        }
        source_index(op, ecx, op->byte);
        movzx(eax, ram_cell(rcx, op->byte));
        change(op->k);
        op->byte ? mov(ram_cell(rcx, true), al) : mov(ram_cell(rcx, false), ax);
        move_source(op, op->byte);
        return true;
    case FormId::BSET_f_bit4:
    case FormId::BCLR_f_bit4:
    case FormId::BTG_f_bit4: {
        int file = 0;
        if (!ram_literal(op->k, true, file)) return emit_clear_flag(op);
        // As a word: a later load of it would wait for a store of half of it.
        movzx(eax, file_cell(file & ~1, false));
        change(std::uint32_t{op->aux} << (file & 1 ? 8 : 0));
        store_file(file & ~1, eax, false);
        return true;
    }
    default:
        return emit_bit_test(op);
    }
}

void Emitter::bit_to_z(std::uint32_t mask) {
    and_(eax, mask);
    mov(r11d, eax);
    flags_.z = From::Result;
}

bool Emitter::emit_bit_test(const Op* op) {
    const bool to_z = op->form == FormId::BTST_Z_Ws_bit4 || op->form == FormId::BTST_Z_Ws_Wb ||
                      op->form == FormId::BTST_f_bit4;
    const auto prepare = [&] {
        if (to_z && flags_.n == From::Result) flush_flags();  // r11 is wanted for Z alone
    };
    switch (op->form) {
    case FormId::BTST_f_bit4: {
        if (!can_read_literal(op->k, true)) return false;
        prepare();
        movzx(eax, read_literal(op->k, true));
        bit_to_z(op->aux);
        return true;
    }
    case FormId::BTST_C_Ws_bit4:
    case FormId::BTST_Z_Ws_bit4:
        prepare();
        if (op->source == Ea::Indirect) read_index(op, false);
        load_source(op, eax, false);
        move_source(op, false);
        if (to_z) {
            bit_to_z(op->k);
            return true;
        }
        mov(esi, eax);
        if (const int bit = std::countr_zero(op->k); bit > 0) shr(esi, bit);
        break;
    case FormId::BTST_C_Ws_Wb:
    case FormId::BTST_Z_Ws_Wb:
        prepare();
        if (op->source == Ea::Indirect) read_index(op, false);
        load_source(op, eax, false);
        load_w(ecx, op->b, false);
        move_source(op, false);
        and_(ecx, 15);
        shr(eax, cl);
        if (to_z) {
            bit_to_z(1);
            return true;
        }
        mov(esi, eax);
        break;
    default:
        return false;
    }
    and_(esi, 1);
    flags_.c = From::Bit;
    return true;
}

}  // namespace puckloop::dspic::translate
