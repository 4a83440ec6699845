#pragma once
// Branches, calls, returns and what costs time only, over any domain (words.h). A branch not taken takes 1
// cycle, taken 2; what else an instruction does to the processor is in flow.cpp, for the interpreter alone.

#include "emu/dspic/machine/execute/handlers.h"

namespace puckloop::dspic {

enum class If { Always, OV, C, Z, N, LE, LT, LEU, NOV, NC, NZ, NN, GT, GE, GTU, OA, OB, SA, SB };

template <If Condition, class D>
bool holds(D& d) {
    const auto less = [&] { return d.n() != d.ov(); };
    switch (Condition) {
    case If::Always:
        return true;
    case If::OV:
        return d.ov();
    case If::C:
        return d.c();
    case If::Z:
        return d.z();
    case If::N:
        return d.n();
    case If::LE:
        return d.z() || less();
    case If::LT:
        return less();
    case If::LEU:
        return !d.c() || d.z();
    case If::NOV:
        return !d.ov();
    case If::NC:
        return !d.c();
    case If::NZ:
        return !d.z();
    case If::NN:
        return !d.n();
    case If::GT:
        return !d.z() && !less();
    case If::GE:
        return !less();
    case If::GTU:
        return d.c() && !d.z();
    case If::OA:
        return d.accumulator(sr::OA);
    case If::OB:
        return d.accumulator(sr::OB);
    case If::SA:
        return d.accumulator(sr::SA);
    case If::SB:
        return d.accumulator(sr::SB);
    }
}

/// A program address that lies `words` instruction words from `from`.
constexpr std::uint32_t relative_pc(std::uint32_t from, std::uint32_t words) {
    return (from + 2 * static_cast<std::uint32_t>(static_cast<std::int16_t>(words))) & kProgramSpace;
}
/// The target of CALL and GOTO, whose words hold its upper and its lower half.
inline std::uint32_t far_target(const Form& form, std::uint32_t word, std::uint32_t word2) {
    return form.field2('n', word2) << 16 | form.field('n', word) << 1;
}

/// BRA, with or without a condition, and GOTO.
template <If Condition>
struct Branch {
    static constexpr bool kConditional = Condition != If::Always;

    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape) {
        if constexpr (kConditional) {
            d.decides();
            if (!holds<Condition>(d)) return op + 1;
        }
        return d.branch(op, kConditional);
    }
    static void bind(Op& op, const Form& form, std::uint32_t word, std::uint32_t word2, std::uint32_t pc) {
        constexpr std::uint32_t kFarthest = 128;  // a busy wait is shorter
        if (form.two_words()) {
            op.target = far_target(form, word, word2);
            op.may_skip = op.target <= pc && pc - op.target <= kFarthest;
        } else {
            const std::uint32_t words = form.field('n', word);
            op.target = relative_pc(pc + 2, words);
            op.may_skip = (words & 0x8000) && 0x10000 - words <= kFarthest / 2;
        }
        using Any = Fixed<false, Ea::Literal, Ea::Literal>;
        op.base = op.may_skip ? &execute<Branch, Any, LoopingWords> : &execute<Branch, Any>;
    }
};

template <class D>
void push_return(D& d, std::uint32_t pc) {
    d.push(d.value(stacked_pc_low(pc)));
    d.push(d.value(pc >> 16));
}
template <class D>
std::uint32_t pop_return(D& d) {
    const std::uint32_t high = d.word(d.pop());
    return stacked_pc(static_cast<std::uint16_t>(d.word(d.pop())), static_cast<std::uint16_t>(high));
}

/// CALL (two words) and RCALL; k = bytes of the instruction in program-counter units.
struct Call {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape) {
        push_return(d, d.pc_of(op) + op->k);
        return d.go(op->target);
    }
    static void bind(Op& op, const Form& form, std::uint32_t word, std::uint32_t word2, std::uint32_t pc) {
        const bool far = form.two_words();
        op.k = far ? 4 : 2;
        op.target = far ? far_target(form, word, word2) : relative_pc(pc + 2, form.field('n', word));
        op.base = pick<Call, false, kNone, kNone>(op);
    }
};
/// BRA Wn, GOTO Wn, CALL Wn, RCALL Wn.
template <bool Relative, bool Calls>
struct Computed {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape) {
        const std::uint32_t w = d.word(d.whole(op->s));
        if constexpr (Calls) push_return(d, op->target);
        return d.go(Relative ? relative_pc(op->target, w) : w & 0xFFFE);
    }
    static void bind(Op& op, const Form& form, std::uint32_t word, std::uint32_t, std::uint32_t pc) {
        op.s = static_cast<std::uint8_t>(form.field('s', word));
        op.target = pc + 2;
        op.base = pick<Computed, false, kNone, kNone>(op);
    }
};
struct Return {
    template <class D, class Shape>
    static const Op* run(D& d, const Op*, Shape) {
        return d.return_to(pop_return(d));
    }
    static void bind(Op& op, const Form&, std::uint32_t, std::uint32_t, std::uint32_t) {
        op.uses |= 1u << 15;
        op.base = pick<Return, false, kNone, kNone>(op);
    }
};
/// RETLW #lit10,Wn.
struct ReturnLiteral {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        const std::uint32_t address = pop_return(d);
        d.put(op->d, shape.byte, d.value(op->k & ones(shape.byte)));
        return d.return_to(address);
    }
    static void bind(Op& op, const Form& form, std::uint32_t word, std::uint32_t, std::uint32_t) {
        op.uses |= 1u << 15;
        op.k = static_cast<std::uint16_t>(form.field('k', word));
        op.d = static_cast<std::uint8_t>(form.field('d', word));
        initialises(op, op.d);
        op.base = pick<ReturnLiteral, true, kNone, kNone>(op);
    }
};
struct Nop {
    template <class D, class Shape>
    static const Op* run(D&, const Op* op, Shape) {
        return op + 1;
    }
    static void bind(Op& op, const Form&, std::uint32_t, std::uint32_t, std::uint32_t) {
        op.base = pick<Nop, false, kNone, kNone>(op);
    }
};
struct ClearWatchdog {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape) {
        d.clear_watchdog();
        return op + 1;
    }
    static void bind(Op& op, const Form&, std::uint32_t, std::uint32_t, std::uint32_t) {
        op.base = pick<ClearWatchdog, false, kNone, kNone>(op);
    }
};

/// Calls `use` with the semantics of a form of this file; false if it is none.
template <class Use>
bool with_branch(FormId id, Use use) {
    switch (id) {
        // clang-format off
#define BRANCH(NAME) case FormId::BRA_##NAME##_Expr: return use(Branch<If::NAME>{}), true;
    BRANCH(OV) BRANCH(C) BRANCH(Z) BRANCH(N) BRANCH(LE) BRANCH(LT) BRANCH(LEU) BRANCH(NOV) BRANCH(NC)
    BRANCH(NZ) BRANCH(NN) BRANCH(GT) BRANCH(GE) BRANCH(GTU) BRANCH(OA) BRANCH(OB) BRANCH(SA) BRANCH(SB)
#undef BRANCH
    case FormId::BRA_Expr: case FormId::GOTO_Expr: return use(Branch<If::Always>{}), true;
    case FormId::BRA_Wn: return use(Computed<true, false>{}), true;
    case FormId::GOTO_Wn: return use(Computed<false, false>{}), true;
    case FormId::CALL_Expr: case FormId::RCALL_Expr: return use(Call{}), true;
    case FormId::CALL_Wn: return use(Computed<false, true>{}), true;
    case FormId::RCALL_Wn: return use(Computed<true, true>{}), true;
    case FormId::RETURN: return use(Return{}), true;
    case FormId::RETLW_lit10_Wn: return use(ReturnLiteral{}), true;
    case FormId::NOP: case FormId::NOPR: return use(Nop{}), true;
    case FormId::CLRWDT: return use(ClearWatchdog{}), true;
    // clang-format on
    default:
        return false;
    }
}

}  // namespace puckloop::dspic
