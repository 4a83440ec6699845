#pragma once
// Shifts and rotates by one, shifts by many, sign and zero extension, byte swapping, bit searching, over any
// domain (words.h).

#include "emu/dspic/machine/execute/forms.h"

#include <bit>

namespace puckloop::dspic {

// By one bit: C is the bit shifted out; OV and DC stay. Rotates not through C leave C alone.
struct Sl {
    template <class D, class V>
    static V apply(D& d, bool byte, V s) {
        return d.shifted(byte, d.doubled(byte, s, false), d.bit(s, top(byte)));
    }
};
struct Lsr {
    template <class D, class V>
    static V apply(D& d, bool byte, V s) {
        return d.shifted(byte, d.halved(byte, s, false), d.bit(s, 1));
    }
};
struct Asr {
    template <class D, class V>
    static V apply(D& d, bool byte, V s) {
        return d.shifted(byte, d.halved(byte, s, d.bit(s, top(byte))), d.bit(s, 1));
    }
};
struct Rlnc {
    template <class D, class V>
    static V apply(D& d, bool byte, V s) {
        return d.logic(byte, d.doubled(byte, s, d.bit(s, top(byte))));
    }
};
struct Rlc {
    template <class D, class V>
    static V apply(D& d, bool byte, V s) {
        return d.shifted(byte, d.doubled(byte, s, d.c()), d.bit(s, top(byte)));
    }
};
struct Rrnc {
    template <class D, class V>
    static V apply(D& d, bool byte, V s) {
        return d.logic(byte, d.halved(byte, s, d.bit(s, 1)));
    }
};
struct Rrc {
    template <class D, class V>
    static V apply(D& d, bool byte, V s) {
        return d.shifted(byte, d.halved(byte, s, d.c()), d.bit(s, 1));
    }
};

/// By many bits, words only: C stays. Counts of 16 to 31 shift everything out.
enum class Many { Left, Logical, Arithmetic };
template <Many Kind>
struct ManyBits {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        const auto value = d.whole(op->b);
        const auto count =
            shape.source == Ea::Literal ? d.value(op->k) : d.conjunction(d.whole(op->s), d.value(31));
        const auto result = [&] {
            if constexpr (Kind == Many::Left) return d.left(value, count);
            if constexpr (Kind == Many::Logical) return d.right(value, count);
            if constexpr (Kind == Many::Arithmetic) return d.signed_right(value, count);
        }();
        d.set_whole(op->d, d.logic(false, result));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_base(op, form, word);
        bind_w(op, form, word);
        if (form.has_field('k')) {
            op.k = static_cast<std::uint16_t>(form.field('k', word));
        } else {
            op.s = static_cast<std::uint8_t>(form.field('s', word));
            op.source = Ea::Direct;
        }
        op.base = pick<ManyBits, false, modes(Ea::Literal, Ea::Direct), kNone>(op);
    }
};

/// SE and ZE: C is the complement of N.
template <bool Signed>
struct Extend {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        const auto s = d.source(op, AsByte<Shape>(shape));
        const auto extended = Signed ? d.sign_extended(s) : s;
        d.set_whole(op->d, d.shifted(false, extended, !d.bit(extended, top(false))));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_source(op, form, word, 'p', 1);
        bind_w(op, form, word);
        op.base = pick<Extend, false, kDirectOrIndirect, kNone>(op);
    }
};

struct Swap {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        d.put(op->s, shape.byte, d.swapped(shape.byte, d.whole(op->s)));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        op.s = static_cast<std::uint8_t>(form.field('s', word));
        sets(op, op.s);
        op.base = pick<Swap, true, kNone, kNone>(op);
    }
};
struct Exchange {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape) {
        const auto s = d.whole(op->s);
        const auto w = d.whole(op->d);
        d.set_whole(op->s, w);
        d.set_whole(op->d, s);
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        op.s = static_cast<std::uint8_t>(form.field('s', word));
        bind_w(op, form, word);
        sets(op, op.s);
        op.base = pick<Exchange, false, kNone, kNone>(op);
    }
};
/// Decimal adjust of the low byte after an addition of packed BCD; C only ever gets set.
struct DecimalAdjust {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape) {
        std::uint32_t t = d.word(d.part(op->s, true));
        if ((t & 0xF) > 9 || d.dc()) t += 0x06;
        if (t > 0x9F || d.decided(d.c())) t += 0x60;
        if (t > 0xFF)
            d.set_c(true);
        else if (d.daw_clears_carry())
            d.set_c(false);
        d.put(op->s, true, d.value(t & 0xFF));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        op.s = static_cast<std::uint8_t>(form.field('s', word));
        sets(op, op.s);
        op.base = pick<DecimalAdjust, false, kNone, kNone>(op);
    }
};

/// FF1L, FF1R, FBCL; C: nothing was found.
enum class Search { FirstLeft, FirstRight, BitChangeLeft };
template <Search Kind>
struct Find {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        const auto s = static_cast<std::uint16_t>(d.word(d.source(op, shape)));
        int result = 0;
        bool none = false;
        if constexpr (Kind == Search::FirstLeft) result = s ? std::countl_zero(s) + 1 : 0;
        if constexpr (Kind == Search::FirstRight) result = s ? std::countr_zero(s) + 1 : 0;
        if constexpr (Kind == Search::BitChangeLeft) {
            const auto folded = static_cast<std::uint16_t>(s & 0x8000 ? ~s : s);
            result = -(std::countl_zero(folded) - 1);
            none = result == -15;
        } else {
            none = result == 0;
        }
        d.set_c(none);
        d.set_whole(op->d, d.value(static_cast<std::uint32_t>(result) & 0xFFFF));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_source(op, form, word, 'p', 2);
        bind_w(op, form, word);
        op.base = pick<Find, false, kDirectOrIndirect, kNone>(op);
    }
};

/// Calls `use` with the semantics of a form of this file; false if it is none.
template <class Use>
bool with_shift(FormId id, Use use) {
    switch (id) {
        // clang-format off
#define ONE(NAME, OPERATION)                                                                           \
    case FormId::NAME##_f: return use(OneFile<OPERATION, true>{}), true;                               \
    case FormId::NAME##_f_WREG: return use(OneFile<OPERATION, false>{}), true;                         \
    case FormId::NAME##_Ws_Wd: return use(OneOperand<OPERATION>{}), true;
    ONE(SL, Sl) ONE(LSR, Lsr) ONE(ASR, Asr) ONE(RLNC, Rlnc) ONE(RLC, Rlc) ONE(RRNC, Rrnc) ONE(RRC, Rrc)
#undef ONE
    case FormId::SL_Wb_lit4_Wnd: case FormId::SL_Wb_Wns_Wnd: return use(ManyBits<Many::Left>{}), true;
    case FormId::LSR_Wb_lit4_Wnd: case FormId::LSR_Wb_Wns_Wnd: return use(ManyBits<Many::Logical>{}), true;
    case FormId::ASR_Wb_lit4_Wnd: case FormId::ASR_Wb_Wns_Wnd: return use(ManyBits<Many::Arithmetic>{}), true;
    case FormId::FF1L_Ws_Wnd: return use(Find<Search::FirstLeft>{}), true;
    case FormId::FF1R_Ws_Wnd: return use(Find<Search::FirstRight>{}), true;
    case FormId::FBCL_Ws_Wnd: return use(Find<Search::BitChangeLeft>{}), true;
    case FormId::SE_Ws_Wnd: return use(Extend<true>{}), true;
    case FormId::ZE_Ws_Wnd: return use(Extend<false>{}), true;
    case FormId::EXCH_Wns_Wnd: return use(Exchange{}), true;
    case FormId::SWAP_Wn: return use(Swap{}), true;
    case FormId::DAW_B_Wn: return use(DecimalAdjust{}), true;
    // clang-format on
    default:
        return false;
    }
}

}  // namespace puckloop::dspic
