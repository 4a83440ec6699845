// Adding, subtracting, logic, comparing.

#include "emu/dspic/translate/emitter.h"

namespace puckloop::dspic::translate {

using namespace Xbyak::util;

namespace {

constexpr std::uint32_t ones(bool byte_size) {
    return byte_size ? 0xFF : 0xFFFF;
}

}  // namespace

bool Emitter::takes_carry(const Two& two) {
    return two.sum && (two.adder == Sum::AddC || two.adder == Sum::SubB || two.adder == Sum::SubBR);
}

Xbyak::Reg32 Emitter::base_register(const Two& two) {
    if (!two.sum) return r11d;
    return two.adder == Sum::SubR || two.adder == Sum::SubBR ? r9d : r8d;
}

Xbyak::Reg32 Emitter::other_register(const Two& two) {
    if (!two.sum) return eax;
    return two.adder == Sum::SubR || two.adder == Sum::SubBR ? r8d : r9d;
}

Xbyak::Reg32 Emitter::combine(const Two& two, bool byte_size) {
    if (!two.sum) {
        if (two.logic == Logic::And) and_(r11d, eax);
        if (two.logic == Logic::Ior) or_(r11d, eax);
        if (two.logic == Logic::Xor) xor_(r11d, eax);
        set_result(byte_size);
        return r11d;
    }
    const bool subtracts = two.adder != Sum::Add && two.adder != Sum::AddC;
    if (subtracts) xor_(r9d, ones(byte_size));
    if (takes_carry(two)) {
        carry_to(eax);  // from SR: flush_flags() came first
        lea(r10d, ptr[r8 + r9]);
        add(r10d, eax);
        set_sum(byte_size, -1, true);
    } else {
        const int carry = subtracts ? 1 : 0;
        lea(r10d, ptr[r8 + r9 + carry]);
        set_sum(byte_size, carry, false);
    }
    return r10d;
}

std::optional<Emitter::Two> Emitter::two_operands(FormId form) {
    switch (form) {
        // clang-format off
#define SUM(NAME, ADDER)                                                                                 \
    case FormId::NAME##_f: case FormId::NAME##_f_WREG: case FormId::NAME##_Wb_lit5_Wd:                   \
    case FormId::NAME##_Wb_Ws_Wd: return Two{true, Sum::ADDER, {}};
    SUM(ADD, Add) SUM(ADDC, AddC) SUM(SUB, Sub) SUM(SUBB, SubB) SUM(SUBR, SubR) SUM(SUBBR, SubBR)
#undef SUM
#define LOGIC(NAME, OPERATION)                                                                           \
    case FormId::NAME##_f: case FormId::NAME##_f_WREG: case FormId::NAME##_Wb_lit5_Wd:                   \
    case FormId::NAME##_Wb_Ws_Wd: case FormId::NAME##_lit10_Wn: return Two{false, {}, Logic::OPERATION};
    LOGIC(AND, And) LOGIC(IOR, Ior) LOGIC(XOR, Xor)
#undef LOGIC
    case FormId::ADD_lit10_Wn: return Two{true, Sum::Add, {}};
    case FormId::ADDC_lit10_Wn: return Two{true, Sum::AddC, {}};
    case FormId::SUB_lit10_Wn:
    case FormId::CP_f: case FormId::CP_Wb_lit5: case FormId::CP_Wb_Ws: return Two{true, Sum::Sub, {}};
    case FormId::SUBB_lit10_Wn:
    case FormId::CPB_f: case FormId::CPB_Wb_lit5: case FormId::CPB_Wb_Ws: return Two{true, Sum::SubB, {}};
        // clang-format on
    default:
        return std::nullopt;
    }
}

Emitter::Shape Emitter::shape_of(const Op* op) {
    const std::string_view operands = form(op->form).operands;
    if (operands == "f") return Shape::File;
    if (operands == "f,WREG") return Shape::FileToW0;
    if (operands == "#lit10,Wn") return Shape::LiteralToW;
    return Shape::Pointers;
}

bool Emitter::emit_two_operands(const Op* op, const Two& two) {
    const bool compares = op->form == FormId::CP_f || op->form == FormId::CPB_f ||
                          op->form == FormId::CP_Wb_lit5 || op->form == FormId::CP_Wb_Ws ||
                          op->form == FormId::CPB_Wb_lit5 || op->form == FormId::CPB_Wb_Ws;
    const Shape shape = shape_of(op);
    const Xbyak::Reg32 base = base_register(two), other = other_register(two);
    int file = 0;
    if (shape == Shape::File || shape == Shape::FileToW0) {
        const bool writes = shape == Shape::File && !compares;
        if (writes ? !ram_literal(op->k, op->byte, file) : !can_read_literal(op->k, op->byte)) return false;
        if (takes_carry(two)) flush_flags();
        movzx(base, read_literal(op->k, op->byte));
        load_w(other, 0, op->byte);
        const Xbyak::Reg32 result = combine(two, op->byte);
        if (compares) return true;
        if (shape == Shape::File)
            store_file(file, result, op->byte);
        else
            store_w(0, result, op->byte);
        return true;
    }
    if (shape == Shape::LiteralToW) {
        if (takes_carry(two)) flush_flags();
        load_w(base, op->d, op->byte);
        mov(other, op->k);
        store_w(op->d, combine(two, op->byte), op->byte);
        return true;
    }
    Op reached = *op;
    if (compares) reached.destination = Ea::Literal;
    if (!can_reach(&reached)) return false;
    if (takes_carry(two)) flush_flags();
    reach(&reached, op->byte);
    load_w(base, op->b, op->byte);
    load_source(op, other, op->byte);
    move_source(op, op->byte);
    const Xbyak::Reg32 result = combine(two, op->byte);
    if (compares) return true;
    move_destination(op, op->byte);
    store_destination(op, result, op->byte);
    return true;
}

bool Emitter::emit_alu(const Op* op) {
    if (const std::optional<Two> two = two_operands(op->form)) return emit_two_operands(op, *two);
    switch (op->form) {
    case FormId::CP0_f: {
        if (!can_read_literal(op->k, op->byte)) return false;
        movzx(r8d, read_literal(op->k, op->byte));
        break;
    }
    case FormId::CP0_Ws: {
        if (op->source == Ea::Indirect) read_index(op, op->byte);
        load_source(op, r8d, op->byte);
        move_source(op, op->byte);
        break;
    }
    default:
        return emit_one_operand(op);
    }
    mov(r9d, ones(op->byte));
    lea(r10d, ptr[r8 + r9 + 1]);
    set_sum(op->byte, 1, false);
    return true;
}

void Emitter::add_constant(std::uint32_t constant, int carry, bool byte_size) {
    mov(r9d, constant & ones(byte_size));
    lea(r10d, ptr[r8 + r9 + carry]);
    set_sum(byte_size, carry, false);
}

bool Emitter::emit_one_operand(const Op* op) {
    const std::optional<One> one = one_operand(op->form);
    if (!one) return false;
    const std::string_view operands = form(op->form).operands;
    const bool of_file = operands == "f" || operands.ends_with("WREG");
    const bool sets = *one == One::Clear || *one == One::Set;
    int file = 0;
    if (of_file && !ram_literal(op->k, op->byte, file) && !(sets && operands == "WREG")) return false;
    Op reached = *op;
    if (sets) reached.source = Ea::Literal;
    if (!of_file) {
        if (!can_reach(&reached)) return false;
        reach(&reached, op->byte);
    }
    const bool sums = *one >= One::Inc && *one <= One::Neg;
    const Xbyak::Reg32 in = *one == One::Neg ? r9d : sums ? r8d : eax;
    if (!sets) {
        if (of_file)
            movzx(in, file_cell(file, op->byte));
        else
            load_source(op, in, op->byte);
        if (!of_file) move_source(op, op->byte);
    }
    const Xbyak::Reg32 result = apply(*one, op->byte);
    if (of_file) {
        if (operands == "f")
            store_file(file, result, op->byte);
        else
            store_w(0, result, op->byte);
    } else {
        move_destination(op, op->byte);
        store_destination(op, result, op->byte);
    }
    return true;
}

std::optional<Emitter::One> Emitter::one_operand(FormId form) {
    switch (form) {
        // clang-format off
#define ONE(NAME, OPERATION)                                                                             \
    case FormId::NAME##_f: case FormId::NAME##_f_WREG: case FormId::NAME##_Ws_Wd: return One::OPERATION;
    ONE(INC, Inc) ONE(INC2, Inc2) ONE(DEC, Dec) ONE(DEC2, Dec2) ONE(NEG, Neg) ONE(COM, Com)
    ONE(SL, Sl) ONE(LSR, Lsr) ONE(ASR, Asr) ONE(RLNC, Rlnc) ONE(RLC, Rlc) ONE(RRNC, Rrnc) ONE(RRC, Rrc)
#undef ONE
    case FormId::CLR_f: case FormId::CLR_WREG: case FormId::CLR_Wd: return One::Clear;
    case FormId::SETM_f: case FormId::SETM_WREG: case FormId::SETM_Wd: return One::Set;
        // clang-format on
    default:
        return std::nullopt;
    }
}

}  // namespace puckloop::dspic::translate
