// Reaching operands: W registers, data RAM through pointers and literal addresses. An instruction's checks
// come before anything it changes, so that it can still be left to the interpreter.

#include "emu/dspic/translate/emitter.h"

namespace puckloop::dspic::translate {

using namespace Xbyak::util;

void Emitter::load_w(const Xbyak::Reg32& to, int reg, bool byte_size) {
    movzx(to, byte_size ? w_byte(reg) : w_word(reg));
}

void Emitter::store_w(int reg, const Xbyak::Reg32& from, bool byte_size) {
    Xbyak::Reg32 value = from;
    if (reg == 15) {
        mov(eax, from);
        and_(eax, 0xFFFE);
        value = eax;
    }
    if (byte_size)
        mov(w_byte(reg), value.cvt8());
    else
        mov(w_word(reg), value.cvt16());
}

void Emitter::ram_index(const Xbyak::Reg32& index, int disp, bool byte_size, bool stack, int words) {
    lea(index, ptr[rax + disp - kRamStart]);
    if (stack) {
        cmp(index, dword[rbp + layout_.stack_span]);
        jg(bail(), T_NEAR);
    }
    if (byte_size) {
        cmp(index, layout_.ram_words * 2);
    } else {
        ror(index, 1);  // an odd address becomes an index out of range
        cmp(index, layout_.ram_words - static_cast<std::uint32_t>(words - 1));
    }
    jae(bail(), T_NEAR);
}

Xbyak::Address Emitter::ram_cell(const Xbyak::Reg64& index, bool byte_size) {
    return byte_size ? byte[r12 + index] : word[r12 + index * 2];
}

Xbyak::Address Emitter::file_cell(int displacement, bool byte_size) {
    return byte_size ? byte[r12 + displacement] : word[r12 + displacement];
}

void Emitter::store_file(int displacement, const Xbyak::Reg32& from, bool byte_size) {
    if (byte_size)
        mov(file_cell(displacement, true), from.cvt8());
    else
        mov(file_cell(displacement, false), from.cvt16());
}

bool Emitter::ram_literal(std::uint32_t address, bool byte_size, int& displacement) const {
    constexpr std::uint32_t kStart = kRamStart;
    if (address < kStart || address >= kStart + layout_.ram_words * 2) return false;
    if (!byte_size && address & 1) return false;
    displacement = static_cast<int>(address) - kRamStart;
    return true;
}

void Emitter::source_index(const Op* op, const Xbyak::Reg32& index, bool byte_size, int words) {
    load_w(eax, op->s, false);
    if (op->source == Ea::Offset) {
        load_w(index, op->b, false);
        add(eax, index);
        movzx(eax, ax);
        return ram_index(index, 0, byte_size, op->s == 15, words);
    }
    ram_index(index, op->s_pre, byte_size, op->s == 15, words);
}

void Emitter::read_index(const Op* op, bool byte_size) {
    if (op->s == 15) return source_index(op, ecx, byte_size);
    load_w(eax, op->s, false);
    if (op->source == Ea::Offset) {
        load_w(ecx, op->b, false);
        add(eax, ecx);
        movzx(eax, ax);
        return readable_index(0, byte_size);
    }
    readable_index(op->s_pre, byte_size);
}

void Emitter::destination_index(const Op* op, const Xbyak::Reg32& index, bool byte_size, int words) {
    load_w(eax, op->d, false);
    if (op->destination == Ea::Offset) {
        load_w(index, op->b, false);
        add(eax, index);
        movzx(eax, ax);
        return ram_index(index, 0, byte_size, op->d == 15, words);
    }
    ram_index(index, op->d_pre, byte_size, op->d == 15, words);
}

void Emitter::step_pointer(int reg, int step, bool byte_size) {
    if (step != 0) add(w_word(reg), step);
    if (reg == 15 && byte_size) and_(w_word(reg), -2);
}

void Emitter::move_source(const Op* op, bool byte_size) {
    if (op->source == Ea::Indirect) step_pointer(op->s, op->s_pre + op->s_post, byte_size);
}

void Emitter::move_destination(const Op* op, bool byte_size) {
    if (op->destination == Ea::Indirect) step_pointer(op->d, op->d_pre + op->d_post, byte_size);
}

bool Emitter::can_reach(const Op* op) {
    // A source pointer that moves and is used again for the destination: rare.
    if (op->source != Ea::Indirect || op->s_pre + op->s_post == 0) return true;
    if (op->destination == Ea::Indirect) return op->d != op->s;
    return op->destination != Ea::Offset || (op->d != op->s && op->b != op->s);
}

void Emitter::reach(const Op* op, bool byte_size) {
    if (op->source == Ea::Indirect || op->source == Ea::Offset) read_index(op, byte_size);
    if (op->destination == Ea::Indirect || op->destination == Ea::Offset)
        destination_index(op, edx, byte_size);
}

void Emitter::load_source(const Op* op, const Xbyak::Reg32& to, bool byte_size) {
    if (op->source == Ea::Literal)
        mov(to, op->k);
    else if (op->source == Ea::Direct)
        load_w(to, op->s, byte_size);
    else
        movzx(to, ram_cell(rcx, byte_size));
}

void Emitter::store_destination(const Op* op, const Xbyak::Reg32& from, bool byte_size) {
    if (op->destination == Ea::Direct) return store_w(op->d, from, byte_size);
    if (byte_size)
        mov(ram_cell(rdx, true), from.cvt8());
    else
        mov(ram_cell(rdx, false), from.cvt16());
}

}  // namespace puckloop::dspic::translate
