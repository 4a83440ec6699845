// Adding, subtracting, logic, comparing: everything that goes through the adder and sets its flags.
// DC is the carry out of the low half (bit 3 in byte mode, bit 7 in word mode); ADDC, SUBB, SUBBR and CPB
// never set Z, they only clear it.

#include "emu/dspic/core/execute/one_operand.h"

namespace puckloop::dspic {

namespace {

constexpr std::uint32_t kArithmetic = sr::C | sr::Z | sr::OV | sr::N | sr::DC;

/// a + b + carry, flags included. Subtraction passes ~b and carry = no borrow, as the silicon's adder does.
template <bool Byte, bool StickyZ>
std::uint32_t adder(Machine& m, std::uint32_t a, std::uint32_t b, std::uint32_t carry) {
    constexpr int kBits = Byte ? 8 : 16;
    constexpr std::uint32_t kMask = Byte ? 0xFF : 0xFFFF;
    const std::uint32_t sum = a + b + carry;
    const std::uint32_t carries = a ^ b ^ sum;  // bit n = carry into bit n
    std::uint32_t flags = sum >> kBits & 1;
    flags |= (sum & kMask) == 0 ? sr::Z : 0u;
    flags |= ((a ^ sum) & (b ^ sum)) >> (kBits - 1) << 2 & sr::OV;
    flags |= sum >> (kBits - 1) << 3 & sr::N;
    flags |= Byte ? carries << 4 & sr::DC : carries & sr::DC;
    if constexpr (StickyZ) flags &= m.st.sr | ~std::uint32_t{sr::Z};
    set_flags(m, kArithmetic, flags);
    return sum & kMask;
}

// Two-operand operations: `b` is Wb (or f), `s` the source (or WREG).
template <bool Byte>
constexpr std::uint32_t kOnes = Byte ? 0xFF : 0xFFFF;

struct Add {
    template <bool Byte>
    static std::uint32_t apply(Machine& m, std::uint32_t b, std::uint32_t s) {
        return adder<Byte, false>(m, b, s, 0);
    }
};
struct AddC {
    template <bool Byte>
    static std::uint32_t apply(Machine& m, std::uint32_t b, std::uint32_t s) {
        return adder<Byte, true>(m, b, s, m.st.sr & sr::C);
    }
};
struct Sub {
    template <bool Byte>
    static std::uint32_t apply(Machine& m, std::uint32_t b, std::uint32_t s) {
        return adder<Byte, false>(m, b, s ^ kOnes<Byte>, 1);
    }
};
struct SubB {
    template <bool Byte>
    static std::uint32_t apply(Machine& m, std::uint32_t b, std::uint32_t s) {
        return adder<Byte, true>(m, b, s ^ kOnes<Byte>, m.st.sr & sr::C);
    }
};
struct SubR {
    template <bool Byte>
    static std::uint32_t apply(Machine& m, std::uint32_t b, std::uint32_t s) {
        return adder<Byte, false>(m, s, b ^ kOnes<Byte>, 1);
    }
};
struct SubBR {
    template <bool Byte>
    static std::uint32_t apply(Machine& m, std::uint32_t b, std::uint32_t s) {
        return adder<Byte, true>(m, s, b ^ kOnes<Byte>, m.st.sr & sr::C);
    }
};
template <bool Byte>
std::uint32_t logic(Machine& m, std::uint32_t result) {
    set_flags(m, sr::N | sr::Z, nz<Byte>(result));
    return result;
}
struct And {
    template <bool Byte>
    static std::uint32_t apply(Machine& m, std::uint32_t b, std::uint32_t s) {
        return logic<Byte>(m, b & s);
    }
};
struct Ior {
    template <bool Byte>
    static std::uint32_t apply(Machine& m, std::uint32_t b, std::uint32_t s) {
        return logic<Byte>(m, b | s);
    }
};
struct Xor {
    template <bool Byte>
    static std::uint32_t apply(Machine& m, std::uint32_t b, std::uint32_t s) {
        return logic<Byte>(m, b ^ s);
    }
};

// One-operand operations.
template <int Step>
struct Increment {
    template <bool Byte>
    static std::uint32_t apply(Machine& m, std::uint32_t s) {
        return adder<Byte, false>(m, s, Step, 0);
    }
};
template <int Step>
struct Decrement {
    template <bool Byte>
    static std::uint32_t apply(Machine& m, std::uint32_t s) {
        return adder<Byte, false>(m, s, Step ^ kOnes<Byte>, 1);
    }
};
struct Neg {
    template <bool Byte>
    static std::uint32_t apply(Machine& m, std::uint32_t s) {
        return adder<Byte, false>(m, 0, s ^ kOnes<Byte>, 1);
    }
};
struct Com {
    template <bool Byte>
    static std::uint32_t apply(Machine& m, std::uint32_t s) {
        return logic<Byte>(m, s ^ kOnes<Byte>);
    }
};
struct Clr {
    template <bool Byte>
    static std::uint32_t apply(Machine&, std::uint32_t) {
        return 0;
    }
};
struct Setm {
    template <bool Byte>
    static std::uint32_t apply(Machine&, std::uint32_t) {
        return kOnes<Byte>;
    }
};

// Forms.
template <class Operation, bool Byte, Ea Source, Ea Destination>
const Op* three_operands(Machine& m, const Op* op) {
    const std::uint32_t b = m.st.w[op->b] & kOnes<Byte>;  // read before the source pointer moves
    const std::uint32_t s = source<Byte, Source>(m, op);
    destination<Byte, Destination>(m, op, Operation::template apply<Byte>(m, b, s));
    return op + 1;
}
template <class Operation, bool Byte>
const Op* literal_to_w(Machine& m, const Op* op) {
    const std::uint32_t b = m.st.w[op->d] & kOnes<Byte>;
    put_w<Byte>(m, op->d, Operation::template apply<Byte>(m, b, op->k));
    return op + 1;
}
template <class Operation, bool Byte, bool ToFile>
const Op* file_and_wreg(Machine& m, const Op* op) {
    const std::uint32_t f = read_data<Byte>(m, op->k);
    const std::uint32_t result = Operation::template apply<Byte>(m, f, m.st.w[0] & kOnes<Byte>);
    if constexpr (ToFile)
        write_data<Byte>(m, op->k, static_cast<std::uint16_t>(result));
    else
        put_w<Byte>(m, 0, result);
    return op + 1;
}
template <class Operation, bool Byte, bool ToFile>
const Op* set_file(Machine& m, const Op* op) {  // CLR, SETM: the old contents are not read
    const std::uint32_t result = Operation::template apply<Byte>(m, 0);
    if constexpr (ToFile)
        write_data<Byte>(m, op->k, static_cast<std::uint16_t>(result));
    else
        put_w<Byte>(m, 0, result);
    return op + 1;
}
template <class Operation, bool Byte, Ea Destination>
const Op* set_destination(Machine& m, const Op* op) {
    destination<Byte, Destination>(m, op, Operation::template apply<Byte>(m, 0));
    return op + 1;
}

// Comparisons throw the result away.
template <class Operation, bool Byte, Ea Source>
const Op* compare(Machine& m, const Op* op) {
    const std::uint32_t b = m.st.w[op->b] & kOnes<Byte>;
    const std::uint32_t s = source<Byte, Source>(m, op);
    Operation::template apply<Byte>(m, b, s);
    return op + 1;
}
template <class Operation, bool Byte>
const Op* compare_file(Machine& m, const Op* op) {
    const std::uint32_t f = read_data<Byte>(m, op->k);
    Operation::template apply<Byte>(m, f, m.st.w[0] & kOnes<Byte>);
    return op + 1;
}
template <bool Byte, Ea Source>
const Op* compare_zero(Machine& m, const Op* op) {
    Sub::apply<Byte>(m, source<Byte, Source>(m, op), 0);
    return op + 1;
}
template <bool Byte>
const Op* compare_file_zero(Machine& m, const Op* op) {
    Sub::apply<Byte>(m, read_data<Byte>(m, op->k), 0);
    return op + 1;
}
enum class Test { Equal, NotEqual, Greater, Less };
template <Test Condition, bool Byte>
const Op* compare_skip(Machine& m, const Op* op) {
    const std::uint16_t b = m.st.w[op->b];
    const std::uint16_t s = m.st.w[op->s];
    const auto number = [](std::uint16_t v) {
        return Byte ? static_cast<int>(static_cast<std::int8_t>(v))
                    : static_cast<int>(static_cast<std::int16_t>(v));
    };
    bool skip = false;
    if constexpr (Condition == Test::Equal) skip = number(b) == number(s);
    if constexpr (Condition == Test::NotEqual) skip = number(b) != number(s);
    if constexpr (Condition == Test::Greater) skip = number(b) > number(s);
    if constexpr (Condition == Test::Less) skip = number(b) < number(s);
    return skip ? skip_next(m, op) : op + 1;
}

// Binding: from form and modes to one of the instances above.
template <class Operation, bool Byte, Ea Source>
Handler pick_destination(Ea to) {
    return to == Ea::Direct ? &three_operands<Operation, Byte, Source, Ea::Direct>
                            : &three_operands<Operation, Byte, Source, Ea::Indirect>;
}
template <class Operation, bool Byte>
Handler pick_three(Ea from, Ea to) {
    if (from == Ea::Literal) return pick_destination<Operation, Byte, Ea::Literal>(to);
    if (from == Ea::Direct) return pick_destination<Operation, Byte, Ea::Direct>(to);
    return pick_destination<Operation, Byte, Ea::Indirect>(to);
}
template <class Operation, bool Byte>
Handler pick_compare(Ea from) {
    if (from == Ea::Literal) return &compare<Operation, Byte, Ea::Literal>;
    if (from == Ea::Direct) return &compare<Operation, Byte, Ea::Direct>;
    return &compare<Operation, Byte, Ea::Indirect>;
}

struct Binder {
    Op& op;
    const Form& form;
    std::uint32_t word;
    bool byte;

    int size() const { return byte ? 1 : 2; }
    void operands_w() { op.b = static_cast<std::uint8_t>(form.field('w', word)); }
    void file_address() {
        op.k = static_cast<std::uint16_t>(form.field('f', word));
        if (form.operands.ends_with("WREG")) sets(op, 0);
    }
    Ea from() {
        if (!form.has_field('p')) {
            op.k = static_cast<std::uint16_t>(form.field('k', word));
            return Ea::Literal;
        }
        return bind_source(op, form, word, 'p', size());
    }
    Ea to() { return bind_destination(op, form, word, 'q', size()); }

    template <class Operation>
    bool three() {
        operands_w();
        const Ea f = from();
        const Ea t = to();
        op.base = byte ? pick_three<Operation, true>(f, t) : pick_three<Operation, false>(f, t);
        return true;
    }
    template <class Operation>
    bool literal() {
        op.d = static_cast<std::uint8_t>(form.field('d', word));
        op.k = static_cast<std::uint16_t>(form.field('k', word) & (byte ? 0xFF : 0x3FF));
        sets(op, op.d);
        op.base = byte ? &literal_to_w<Operation, true> : &literal_to_w<Operation, false>;
        return true;
    }
    template <class Operation>
    bool file_wreg(bool to_file) {
        file_address();
        if (to_file)
            op.base = byte ? &file_and_wreg<Operation, true, true> : &file_and_wreg<Operation, false, true>;
        else
            op.base = byte ? &file_and_wreg<Operation, true, false> : &file_and_wreg<Operation, false, false>;
        return true;
    }
    template <class Operation>
    bool set(bool to_file) {
        file_address();
        if (to_file)
            op.base = byte ? &set_file<Operation, true, true> : &set_file<Operation, false, true>;
        else
            op.base = byte ? &set_file<Operation, true, false> : &set_file<Operation, false, false>;
        return true;
    }
    template <class Operation>
    bool set_wd() {
        if (to() == Ea::Direct)
            op.base = byte ? &set_destination<Operation, true, Ea::Direct>
                           : &set_destination<Operation, false, Ea::Direct>;
        else
            op.base = byte ? &set_destination<Operation, true, Ea::Indirect>
                           : &set_destination<Operation, false, Ea::Indirect>;
        return true;
    }
    template <class Operation>
    bool against() {
        operands_w();
        const Ea f = from();
        op.base = byte ? pick_compare<Operation, true>(f) : pick_compare<Operation, false>(f);
        return true;
    }
    template <class Operation>
    bool against_file() {
        file_address();
        op.base = byte ? &compare_file<Operation, true> : &compare_file<Operation, false>;
        return true;
    }
    template <Test Condition>
    bool skip() {
        operands_w();
        op.s = static_cast<std::uint8_t>(form.field('s', word));
        op.base = byte ? &compare_skip<Condition, true> : &compare_skip<Condition, false>;
        return true;
    }
};

}  // namespace

bool bind_alu(Op& op, const Form& form, std::uint32_t word) {
    Binder bind{op, form, word, form.field('B', word) != 0};
    switch (form.id) {
        // clang-format off
#define GROUP(NAME, OPERATION)                                                      \
    case FormId::NAME##_f: return bind.file_wreg<OPERATION>(true);                  \
    case FormId::NAME##_f_WREG: return bind.file_wreg<OPERATION>(false);            \
    case FormId::NAME##_Wb_lit5_Wd: case FormId::NAME##_Wb_Ws_Wd: return bind.three<OPERATION>();
    GROUP(ADD, Add) GROUP(ADDC, AddC) GROUP(SUB, Sub) GROUP(SUBB, SubB) GROUP(SUBR, SubR) GROUP(SUBBR, SubBR)
    GROUP(AND, And) GROUP(IOR, Ior) GROUP(XOR, Xor)
#undef GROUP
    case FormId::ADD_lit10_Wn: return bind.literal<Add>();
    case FormId::ADDC_lit10_Wn: return bind.literal<AddC>();
    case FormId::SUB_lit10_Wn: return bind.literal<Sub>();
    case FormId::SUBB_lit10_Wn: return bind.literal<SubB>();
    case FormId::AND_lit10_Wn: return bind.literal<And>();
    case FormId::IOR_lit10_Wn: return bind.literal<Ior>();
    case FormId::XOR_lit10_Wn: return bind.literal<Xor>();
#define GROUP(NAME, OPERATION)                                                              \
    case FormId::NAME##_f: case FormId::NAME##_f_WREG: case FormId::NAME##_Ws_Wd:           \
        return bind_one_operand<OPERATION>(op, form, word);
    GROUP(INC, Increment<1>) GROUP(INC2, Increment<2>) GROUP(DEC, Decrement<1>) GROUP(DEC2, Decrement<2>)
    GROUP(NEG, Neg) GROUP(COM, Com)
#undef GROUP
    case FormId::CLR_f: return bind.set<Clr>(true);
    case FormId::CLR_WREG: return bind.set<Clr>(false);
    case FormId::SETM_f: return bind.set<Setm>(true);
    case FormId::SETM_WREG: return bind.set<Setm>(false);
    case FormId::CLR_Wd: return bind.set_wd<Clr>();
    case FormId::SETM_Wd: return bind.set_wd<Setm>();
    case FormId::CP_f: return bind.against_file<Sub>();
    case FormId::CPB_f: return bind.against_file<SubB>();
    case FormId::CP_Wb_lit5: case FormId::CP_Wb_Ws: return bind.against<Sub>();
    case FormId::CPB_Wb_lit5: case FormId::CPB_Wb_Ws: return bind.against<SubB>();
    case FormId::CPSEQ_Wb_Wn: return bind.skip<Test::Equal>();
    case FormId::CPSNE_Wb_Wn: return bind.skip<Test::NotEqual>();
    case FormId::CPSGT_Wb_Wn: return bind.skip<Test::Greater>();
    case FormId::CPSLT_Wb_Wn: return bind.skip<Test::Less>();
        // clang-format on
    case FormId::CP0_f:
        bind.file_address();
        op.base = bind.byte ? &compare_file_zero<true> : &compare_file_zero<false>;
        return true;
    case FormId::CP0_Ws: {
        const Ea from = bind.from();
        if (from == Ea::Direct)
            op.base = bind.byte ? &compare_zero<true, Ea::Direct> : &compare_zero<false, Ea::Direct>;
        else
            op.base = bind.byte ? &compare_zero<true, Ea::Indirect> : &compare_zero<false, Ea::Indirect>;
        return true;
    }
    default:
        return false;
    }
}

}  // namespace puckloop::dspic
