// Moving data: MOV in its addressing modes, double words, the stack.

#include "emu/dspic/translate/emitter.h"

namespace puckloop::dspic::translate {

using namespace Xbyak::util;

bool Emitter::emit_move(const Op* op) {
    const bool byte_size = op->byte;
    int file = 0;
    switch (op->form) {
    case FormId::MOV_Ws_Wd:
        if (!can_reach(op)) return false;
        // A destination's offset is read when the source pointer has moved; here neither has.
        reach(op, byte_size);
        load_source(op, eax, byte_size);
        move_source(op, byte_size);
        move_destination(op, byte_size);
        if (op->destination == Ea::Direct && op->d == 15) {
            store_w(15, eax, byte_size);
            return true;
        }
        store_destination(op, eax, byte_size);
        return true;
    case FormId::MOV_WREG_f:
        if (!ram_literal(op->k, byte_size, file)) return false;
        load_w(eax, 0, byte_size);
        store_file(file, eax, byte_size);
        return true;
    case FormId::MOV_f:
    case FormId::MOV_f_WREG:
        if (op->form == FormId::MOV_f ? !ram_literal(op->k, byte_size, file)  // written back
                                      : !can_read_literal(op->k, byte_size))
            return false;
        movzx(r11d, read_literal(op->k, byte_size));
        set_result(byte_size);
        if (op->form == FormId::MOV_f_WREG) store_w(0, r11d, byte_size);
        return true;
    case FormId::MOV_B_lit8_Wnd:
        mov(eax, op->k);
        store_w(op->d, eax, true);
        return true;
    case FormId::MOV_lit16_Wnd:
        mov(eax, op->k);
        store_w(op->d, eax, false);
        return true;
    case FormId::MOV_f_Wnd:
        if (const auto own = core_register(op->k)) {
            movzx(eax, word[rbp + own->place]);
        } else {
            if (!can_read_literal(op->k, false)) return false;
            movzx(eax, read_literal(op->k, false));
        }
        store_w(op->d, eax, false);
        return true;
    case FormId::MOV_Wns_f:
        if (const auto own = core_register(op->k)) {
            load_w(eax, op->s, false);
            and_(eax, own->bits);
            mov(word[rbp + own->place], ax);
            return true;
        }
        if (!ram_literal(op->k, false, file)) return false;
        load_w(eax, op->s, false);
        store_file(file, eax, false);
        return true;
    case FormId::MOV_WsOffset_Wnd:
        load_w(eax, op->s, false);
        if (op->s == 15)
            ram_index(ecx, static_cast<std::int16_t>(op->k), byte_size, true);
        else
            readable_index(static_cast<std::int16_t>(op->k), byte_size);
        movzx(eax, ram_cell(rcx, byte_size));
        store_w(op->d, eax, byte_size);
        return true;
    case FormId::MOV_Wns_WdOffset:
        load_w(eax, op->d, false);
        ram_index(edx, static_cast<std::int16_t>(op->k), byte_size, op->d == 15);
        load_w(eax, op->s, byte_size);
        if (byte_size)
            mov(ram_cell(rdx, true), al);
        else
            mov(ram_cell(rdx, false), ax);
        return true;
    case FormId::MOV_D_Ws_Wnd:
        if (op->d == 14) return false;  // W15 has no bit 0
        if (op->source == Ea::Direct) {
            if (op->s % 2) return false;
            load_w(eax, op->s, false);
            load_w(ecx, op->s + 1, false);
        } else {
            source_index(op, ecx, false, 2);
            movzx(eax, word[r12 + rcx * 2]);
            movzx(ecx, word[r12 + rcx * 2 + 2]);
            move_source(op, false);
        }
        store_w(op->d, eax, false);
        store_w(op->d + 1, ecx, false);
        return true;
    case FormId::MOV_D_Wns_Wd:
        if (op->destination == Ea::Direct) return false;
        destination_index(op, edx, false, 2);
        load_w(eax, op->s, false);
        load_w(ecx, op->s + 1, false);
        move_destination(op, false);
        mov(word[r12 + rdx * 2], ax);
        mov(word[r12 + rdx * 2 + 2], cx);
        return true;
    case FormId::PUSH_f: {
        const auto own = core_register(op->k);
        if (!own && !ram_literal(op->k, false, file)) return false;
        load_w(eax, 15, false);
        ram_index(edx, 0, false, true);
        movzx(eax, own ? word[rbp + own->place] : file_cell(file, false));
        mov(ram_cell(rdx, false), ax);
        add(w_word(15), 2);
        return true;
    }
    case FormId::POP_f: {
        const auto own = core_register(op->k);
        if (!own && !ram_literal(op->k, false, file)) return false;
        load_w(eax, 15, false);
        ram_index(ecx, -2, false, true);
        movzx(eax, ram_cell(rcx, false));
        add(w_word(15), -2);
        if (!own) {
            store_file(file, eax, false);
            return true;
        }
        and_(eax, own->bits);
        mov(word[rbp + own->place], ax);
        return true;
    }
    default:
        return emit_frame(op);
    }
}

bool Emitter::emit_frame(const Op* op) {
    switch (op->form) {
    case FormId::LNK_lit14:
        load_w(eax, 15, false);
        ram_index(edx, 0, false, true);
        load_w(ecx, 14, false);
        mov(ram_cell(rdx, false), cx);
        add(eax, 2);
        mov(w_word(14), ax);
        add(eax, op->k);
        mov(w_word(15), ax);
        return true;
    case FormId::ULNK:
        load_w(eax, 14, false);
        and_(eax, 0xFFFE);
        ram_index(ecx, -2, false, true);
        sub(eax, 2);
        movzx(ecx, ram_cell(rcx, false));
        mov(w_word(15), ax);
        mov(w_word(14), cx);
        return true;
    default:
        return false;
    }
}

}  // namespace puckloop::dspic::translate
