#pragma once
// Adding, subtracting, logic, comparing: everything that goes through the adder and sets its flags, over any
// domain (words.h). Operands are read in the order of the silicon: Wb before a source pointer moves.

#include "emu/dspic/machine/execute/forms.h"

namespace puckloop::dspic {

// What is computed. Two operands: `b` is Wb (or f), `s` the source (or WREG).
struct Add {
    template <class D, class V>
    static V apply(D& d, bool byte, V b, V s) {
        return d.add(byte, false, b, s, false);
    }
};
struct AddC {
    template <class D, class V>
    static V apply(D& d, bool byte, V b, V s) {
        return d.add(byte, true, b, s, d.c());
    }
};
struct Sub {
    template <class D, class V>
    static V apply(D& d, bool byte, V b, V s) {
        return d.add(byte, false, b, d.complement(byte, s), true);
    }
};
struct SubB {
    template <class D, class V>
    static V apply(D& d, bool byte, V b, V s) {
        return d.add(byte, true, b, d.complement(byte, s), d.c());
    }
};
struct SubR {
    template <class D, class V>
    static V apply(D& d, bool byte, V b, V s) {
        return Sub::apply(d, byte, s, b);
    }
};
struct SubBR {
    template <class D, class V>
    static V apply(D& d, bool byte, V b, V s) {
        return SubB::apply(d, byte, s, b);
    }
};
struct And {
    template <class D, class V>
    static V apply(D& d, bool byte, V b, V s) {
        return d.logic(byte, d.conjunction(b, s));
    }
};
struct Ior {
    template <class D, class V>
    static V apply(D& d, bool byte, V b, V s) {
        return d.logic(byte, d.disjunction(b, s));
    }
};
struct Xor {
    template <class D, class V>
    static V apply(D& d, bool byte, V b, V s) {
        return d.logic(byte, d.exclusive(b, s));
    }
};

// One operand.
template <int Step>
struct Increment {
    template <class D, class V>
    static V apply(D& d, bool byte, V s) {
        return Add::apply(d, byte, s, d.value(Step));
    }
};
template <int Step>
struct Decrement {
    template <class D, class V>
    static V apply(D& d, bool byte, V s) {
        return Sub::apply(d, byte, s, d.value(Step));
    }
};
struct Neg {
    template <class D, class V>
    static V apply(D& d, bool byte, V s) {
        return Sub::apply(d, byte, d.value(0), s);
    }
};
struct Com {
    template <class D, class V>
    static V apply(D& d, bool byte, V s) {
        return d.logic(byte, d.exclusive(s, d.value(ones(byte))));
    }
};

// No operand.
struct Clr {
    template <class D>
    static auto apply(D& d, bool) {
        return d.value(0);
    }
};
struct Setm {
    template <class D>
    static auto apply(D& d, bool byte) {
        return d.value(ones(byte));
    }
};

// Comparisons throw the result away.
template <class Operation>
struct Compare {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        const auto b = d.part(op->b, shape.byte);
        const auto s = d.source(op, shape);
        Operation::apply(d, shape.byte, b, s);
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_base(op, form, word);
        bind_source_or_literal(op, form, word);
        op.base = pick<Compare, true, kAnyButOffset, kNone>(op);
    }
};
template <class Operation>
struct CompareFile {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        const auto f = d.load(d.address(op->k), shape.byte);
        Operation::apply(d, shape.byte, f, d.part(0, shape.byte));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        op.k = static_cast<std::uint16_t>(form.field('f', word));
        op.base = pick<CompareFile, true, kNone, kNone>(op);
    }
};
struct CompareZero {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        Sub::apply(d, shape.byte, d.source(op, shape), d.value(0));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_source(op, form, word, 'p', op.byte ? 1 : 2);
        op.base = pick<CompareZero, true, kDirectOrIndirect, kNone>(op);
    }
};
struct CompareFileZero {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        Sub::apply(d, shape.byte, d.load(d.address(op->k), shape.byte), d.value(0));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        op.k = static_cast<std::uint16_t>(form.field('f', word));
        op.base = pick<CompareFileZero, true, kNone, kNone>(op);
    }
};
/// CPSEQ and its like: compare as signed numbers, and skip.
enum class Test { Equal, NotEqual, Greater, Less };
template <Test Condition>
struct CompareSkip {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        const auto b = d.part(op->b, shape.byte);
        const auto s = d.part(op->s, shape.byte);
        if constexpr (Condition == Test::Equal) return d.skip_if(op, d.equal(shape.byte, b, s));
        if constexpr (Condition == Test::NotEqual) return d.skip_if(op, !d.equal(shape.byte, b, s));
        if constexpr (Condition == Test::Greater) return d.skip_if(op, d.less(shape.byte, s, b));
        if constexpr (Condition == Test::Less) return d.skip_if(op, d.less(shape.byte, b, s));
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_base(op, form, word);
        op.s = static_cast<std::uint8_t>(form.field('s', word));
        op.base = pick<CompareSkip, true, kNone, kNone>(op);
    }
};

/// Calls `use` with the semantics of a form of this file; false if it is none.
template <class Use>
bool with_arithmetic(FormId id, Use use) {
    switch (id) {
        // clang-format off
#define TWO(NAME, OPERATION)                                                                           \
    case FormId::NAME##_f: return use(FileAndWreg<OPERATION, true>{}), true;                           \
    case FormId::NAME##_f_WREG: return use(FileAndWreg<OPERATION, false>{}), true;                     \
    case FormId::NAME##_Wb_lit5_Wd: case FormId::NAME##_Wb_Ws_Wd:                                      \
        return use(ThreeOperands<OPERATION>{}), true;
    TWO(ADD, Add) TWO(ADDC, AddC) TWO(SUB, Sub) TWO(SUBB, SubB) TWO(SUBR, SubR) TWO(SUBBR, SubBR)
    TWO(AND, And) TWO(IOR, Ior) TWO(XOR, Xor)
#undef TWO
    case FormId::ADD_lit10_Wn: return use(LiteralToW<Add>{}), true;
    case FormId::ADDC_lit10_Wn: return use(LiteralToW<AddC>{}), true;
    case FormId::SUB_lit10_Wn: return use(LiteralToW<Sub>{}), true;
    case FormId::SUBB_lit10_Wn: return use(LiteralToW<SubB>{}), true;
    case FormId::AND_lit10_Wn: return use(LiteralToW<And>{}), true;
    case FormId::IOR_lit10_Wn: return use(LiteralToW<Ior>{}), true;
    case FormId::XOR_lit10_Wn: return use(LiteralToW<Xor>{}), true;
#define ONE(NAME, ...)                                                                                 \
    case FormId::NAME##_f: return use(OneFile<__VA_ARGS__, true>{}), true;                             \
    case FormId::NAME##_f_WREG: return use(OneFile<__VA_ARGS__, false>{}), true;                       \
    case FormId::NAME##_Ws_Wd: return use(OneOperand<__VA_ARGS__>{}), true;
    ONE(INC, Increment<1>) ONE(INC2, Increment<2>) ONE(DEC, Decrement<1>) ONE(DEC2, Decrement<2>)
    ONE(NEG, Neg) ONE(COM, Com)
#undef ONE
    case FormId::CLR_f: return use(SetFile<Clr, true>{}), true;
    case FormId::CLR_WREG: return use(SetFile<Clr, false>{}), true;
    case FormId::SETM_f: return use(SetFile<Setm, true>{}), true;
    case FormId::SETM_WREG: return use(SetFile<Setm, false>{}), true;
    case FormId::CLR_Wd: return use(SetDestination<Clr>{}), true;
    case FormId::SETM_Wd: return use(SetDestination<Setm>{}), true;
    case FormId::CP_f: return use(CompareFile<Sub>{}), true;
    case FormId::CPB_f: return use(CompareFile<SubB>{}), true;
    case FormId::CP_Wb_lit5: case FormId::CP_Wb_Ws: return use(Compare<Sub>{}), true;
    case FormId::CPB_Wb_lit5: case FormId::CPB_Wb_Ws: return use(Compare<SubB>{}), true;
    case FormId::CP0_f: return use(CompareFileZero{}), true;
    case FormId::CP0_Ws: return use(CompareZero{}), true;
    case FormId::CPSEQ_Wb_Wn: return use(CompareSkip<Test::Equal>{}), true;
    case FormId::CPSNE_Wb_Wn: return use(CompareSkip<Test::NotEqual>{}), true;
    case FormId::CPSGT_Wb_Wn: return use(CompareSkip<Test::Greater>{}), true;
    case FormId::CPSLT_Wb_Wn: return use(CompareSkip<Test::Less>{}), true;
    // clang-format on
    default:
        return false;
    }
}

}  // namespace puckloop::dspic
