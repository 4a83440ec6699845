#pragma once
// Multiplication of the MCU class over any domain (words.h). Division is in multiply.cpp: its steps hold
// partial results of the silicon.

#include "emu/dspic/machine/execute/handlers.h"

namespace puckloop::dspic {

// The product's low word goes to the even register; flags stay.

/// MUL.SS, SU, US, UU of Wb and Ws or #lit5.
template <bool SignedB, bool SignedS>
struct Multiply {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        const auto b = d.whole(op->b);
        const auto s = d.source(op, shape);
        d.set_pair(op->d, d.product(SignedB, b, SignedS, s));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_base(op, form, word);
        bind_source_or_literal(op, form, word);
        bind_w(op, form, word);
        sets(op, op.d + 1);
        op.base = pick<Multiply, false, kAnyButOffset, kNone>(op);
    }
};
/// MUL f: by WREG, to W3:W2, of bytes to W2.
struct MultiplyFile {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        const auto f = d.load(d.address(op->k), shape.byte);
        const auto product = d.product(false, f, false, d.part(0, shape.byte));
        if (shape.byte)
            d.set_whole(2, d.low(product));
        else
            d.set_pair(2, product);
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        op.k = static_cast<std::uint16_t>(form.field('f', word));
        sets(op, 2);
        if (!op.byte) sets(op, 3);
        op.base = pick<MultiplyFile, true, kNone, kNone>(op);
    }
};

/// Calls `use` with the semantics of a form of this file; false if it is none.
template <class Use>
bool with_product(FormId id, Use use) {
    switch (id) {
    case FormId::MUL_SS_Wb_Ws_Wnd:
        return use(Multiply<true, true>{}), true;
    case FormId::MUL_SU_Wb_lit5_Wnd:
    case FormId::MUL_SU_Wb_Ws_Wnd:
        return use(Multiply<true, false>{}), true;
    case FormId::MUL_US_Wb_Ws_Wnd:
        return use(Multiply<false, true>{}), true;
    case FormId::MUL_UU_Wb_lit5_Wnd:
    case FormId::MUL_UU_Wb_Ws_Wnd:
        return use(Multiply<false, false>{}), true;
    case FormId::MUL_f:
        return use(MultiplyFile{}), true;
    default:
        return false;
    }
}

}  // namespace puckloop::dspic
