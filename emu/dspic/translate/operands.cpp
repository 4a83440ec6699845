// Reaching operands: W registers, data RAM through pointers and literal addresses. An instruction's checks
// come before anything it changes, so that it can still be left to the interpreter.

#include "emu/dspic/translate/emitter.h"

namespace puckloop::dspic::translate {

using namespace Xbyak::util;

void Emitter::load_w(const Xbyak::Reg32& to, int reg, bool byte_size) {
    movzx(to, byte_size ? w_byte(reg) : w_word(reg));
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

Xbyak::Address Emitter::file_cell(int displacement, bool byte_size) {
    return byte_size ? byte[r12 + displacement] : word[r12 + displacement];
}

bool Emitter::ram_literal(std::uint32_t address, bool byte_size, int& displacement) const {
    constexpr std::uint32_t kStart = kRamStart;
    if (address < kStart || address >= kStart + layout_.ram_words * 2) return false;
    if (!byte_size && address & 1) return false;
    displacement = static_cast<int>(address) - kRamStart;
    return true;
}

}  // namespace puckloop::dspic::translate
