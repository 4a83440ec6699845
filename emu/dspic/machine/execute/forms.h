#pragma once
// The operand forms that most calculating instructions share: where operands come from and where the result
// goes, whatever is computed (arithmetic.h, shifts.h), over any domain (words.h).

#include "emu/dspic/machine/execute/handlers.h"

namespace puckloop::dspic {

/// Wb,#lit5,Wd and Wb,Ws,Wd.
template <class Operation>
struct ThreeOperands {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        const auto b = d.part(op->b, shape.byte);
        const auto s = d.source(op, shape);
        d.destination(op, shape, Operation::apply(d, shape.byte, b, s));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_base(op, form, word);
        bind_source_or_literal(op, form, word);
        bind_destination(op, form, word, 'q', op.byte ? 1 : 2);
        op.base = pick<ThreeOperands, true, kAnyButOffset, kDirectOrIndirect>(op);
    }
};
/// #lit10,Wn.
template <class Operation>
struct LiteralToW {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        const auto b = d.part(op->d, shape.byte);
        d.put(op->d, shape.byte, Operation::apply(d, shape.byte, b, d.value(op->k)));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        op.d = static_cast<std::uint8_t>(form.field('d', word));
        op.k = static_cast<std::uint16_t>(form.field('k', word) & (op.byte ? 0xFF : 0x3FF));
        sets(op, op.d);
        op.base = pick<LiteralToW, true, kNone, kNone>(op);
    }
};

/// A result to f or to WREG.
template <bool ToFile>
struct FileResult {
    template <class D, class Shape, class V>
    static void put(D& d, const Op* op, Shape shape, V result) {
        if constexpr (ToFile)
            d.store(d.address(op->k), shape.byte, result);
        else
            d.put(0, shape.byte, result);
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        op.k = static_cast<std::uint16_t>(form.field('f', word));
        if (!ToFile) sets(op, 0);
    }
};
/// f and f,WREG with two operands, f and WREG.
template <class Operation, bool ToFile>
struct FileAndWreg {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        const auto f = d.load(d.address(op->k), shape.byte);
        FileResult<ToFile>::put(d, op, shape, Operation::apply(d, shape.byte, f, d.part(0, shape.byte)));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        FileResult<ToFile>::bind(op, form, word);
        op.base = pick<FileAndWreg, true, kNone, kNone>(op);
    }
};
/// f and f,WREG with one operand.
template <class Operation, bool ToFile>
struct OneFile {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        const auto f = d.load(d.address(op->k), shape.byte);
        FileResult<ToFile>::put(d, op, shape, Operation::apply(d, shape.byte, f));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        FileResult<ToFile>::bind(op, form, word);
        op.base = pick<OneFile, true, kNone, kNone>(op);
    }
};
/// Ws,Wd.
template <class Operation>
struct OneOperand {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        const auto s = d.source(op, shape);
        d.destination(op, shape, Operation::apply(d, shape.byte, s));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_source(op, form, word, 'p', op.byte ? 1 : 2);
        bind_destination(op, form, word, 'q', op.byte ? 1 : 2);
        op.base = pick<OneOperand, true, kDirectOrIndirect, kDirectOrIndirect>(op);
    }
};
/// CLR and SETM of f or WREG: the old contents are not read.
template <class Operation, bool ToFile>
struct SetFile {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        FileResult<ToFile>::put(d, op, shape, Operation::apply(d, shape.byte));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        FileResult<ToFile>::bind(op, form, word);
        op.base = pick<SetFile, true, kNone, kNone>(op);
    }
};
template <class Operation>
struct SetDestination {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        d.destination(op, shape, Operation::apply(d, shape.byte));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_destination(op, form, word, 'q', op.byte ? 1 : 2);
        op.base = pick<SetDestination, true, kNone, kDirectOrIndirect>(op);
    }
};

}  // namespace puckloop::dspic
