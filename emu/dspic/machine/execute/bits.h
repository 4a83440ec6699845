#pragma once
// Single bits over any domain (words.h): set, clear, toggle, test, write, skip. The f forms are byte
// accesses; the word's bit number is the index in the byte plus 8 for an odd address.

#include "emu/dspic/machine/execute/handlers.h"

namespace puckloop::dspic {

/// The bit of the f forms is in `aux`, as a mask.
inline void bind_file_bit(Op& op, const Form& form, std::uint32_t word) {
    op.k = static_cast<std::uint16_t>(form.field('f', word));
    op.aux = static_cast<std::uint8_t>(1u << form.field('b', word));
}
/// Ws,#bit4 has the mask in `k`; Ws,Wb the register in `b`.
inline void bind_ws(Op& op, const Form& form, std::uint32_t word, bool writes) {
    const bool direct = bind_source(op, form, word, 'p', op.byte ? 1 : 2) == Ea::Direct;
    if (form.has_field('b')) op.k = static_cast<std::uint16_t>(1u << form.field('b', word));
    if (form.has_field('w')) bind_base(op, form, word);
    if (direct && writes) sets(op, op.s);
}

/// Ws is read, changed and written back.
template <class D, class Shape, class Change>
void change_source(D& d, const Op* op, Shape shape, Change change) {
    if (shape.source == Ea::Direct)
        d.put(op->s, shape.byte, change(d.part(op->s, shape.byte)));
    else
        d.change(d.source_ea(op, shape.byte), shape.byte, change);
}

enum class Action { Set, Clear, Toggle };
template <Action What>
struct ChangeBit {
    template <class D, class V>
    static V apply(D& d, V value, std::uint32_t mask) {
        if constexpr (What == Action::Set) return d.disjunction(value, d.value(mask));
        if constexpr (What == Action::Clear) return d.conjunction(value, d.value(~mask & 0xFFFF));
        if constexpr (What == Action::Toggle) return d.exclusive(value, d.value(mask));
    }
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        change_source(d, op, shape, [&](auto value) { return apply(d, value, op->k); });
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_ws(op, form, word, true);
        op.base = pick<ChangeBit, true, kDirectOrIndirect, kNone>(op);
    }
};
template <Action What>
struct ChangeFileBit {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape) {
        d.change(d.address(op->k), true,
                 [&](auto value) { return ChangeBit<What>::apply(d, value, op->aux); });
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_file_bit(op, form, word);
        op.base = pick<ChangeFileBit, false, kNone, kNone>(op);
    }
};

/// C = bit, or Z = not bit.
template <bool ToC, class D>
void set_tested(D& d, typename D::Bit bit) {
    if constexpr (ToC)
        d.set_c(bit);
    else
        d.set_z(!bit);
}

/// BTST and BTSTS of Ws,#bit4.
template <bool ToC, bool ThenSet>
struct TestBit {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        if constexpr (ThenSet) {
            change_source(d, op, shape, [&](auto value) {
                set_tested<ToC>(d, d.bit(value, op->k));
                return ChangeBit<Action::Set>::apply(d, value, op->k);
            });
        } else {
            set_tested<ToC>(d, d.bit(d.source(op, shape), op->k));
        }
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_ws(op, form, word, ThenSet);
        op.base = pick<TestBit, false, kDirectOrIndirect, kNone>(op);
    }
};
/// BTST of Ws,Wb.
template <bool ToC>
struct TestBitByW {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        // Read before the source pointer moves.
        const auto place = d.conjunction(d.whole(op->b), d.value(15));
        set_tested<ToC>(d, d.bit(d.right(d.source(op, shape), place), 1));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_ws(op, form, word, false);
        op.base = pick<TestBitByW, false, kDirectOrIndirect, kNone>(op);
    }
};
template <bool ThenSet>
struct TestFileBit {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape) {
        const auto value = d.load(d.address(op->k), true);
        d.set_z(!d.bit(value, op->aux));
        if constexpr (ThenSet)
            d.store(d.address(op->k), true, ChangeBit<Action::Set>::apply(d, value, op->aux));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_file_bit(op, form, word);
        op.base = pick<TestFileBit, false, kNone, kNone>(op);
    }
};

/// BSW.C writes C, BSW.Z writes the complement of Z.
template <bool FromC>
struct WriteBit {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        const auto place = d.conjunction(d.whole(op->b), d.value(15));
        const auto bit = FromC ? d.c() : !d.z();
        change_source(d, op, shape, [&](auto value) { return d.with_bit(value, place, bit); });
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_ws(op, form, word, true);
        op.base = pick<WriteBit, false, kDirectOrIndirect, kNone>(op);
    }
};

template <bool IfSet>
struct SkipOnBit {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        const auto bit = d.bit(d.source(op, shape), op->k);
        return d.skip_if(op, bit == IfSet);
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_ws(op, form, word, false);
        op.base = pick<SkipOnBit, false, kDirectOrIndirect, kNone>(op);
    }
};
template <bool IfSet>
struct SkipOnFileBit {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape) {
        const auto bit = d.bit(d.load(d.address(op->k), true), op->aux);
        return d.skip_if(op, bit == IfSet);
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_file_bit(op, form, word);
        op.base = pick<SkipOnFileBit, false, kNone, kNone>(op);
    }
};

/// Calls `use` with the semantics of a form of this file; false if it is none.
template <class Use>
bool with_bits(FormId id, Use use) {
    switch (id) {
        // clang-format off
    case FormId::BSET_Ws_bit4: return use(ChangeBit<Action::Set>{}), true;
    case FormId::BCLR_Ws_bit4: return use(ChangeBit<Action::Clear>{}), true;
    case FormId::BTG_Ws_bit4: return use(ChangeBit<Action::Toggle>{}), true;
    case FormId::BSET_f_bit4: return use(ChangeFileBit<Action::Set>{}), true;
    case FormId::BCLR_f_bit4: return use(ChangeFileBit<Action::Clear>{}), true;
    case FormId::BTG_f_bit4: return use(ChangeFileBit<Action::Toggle>{}), true;
    case FormId::BTST_f_bit4: return use(TestFileBit<false>{}), true;
    case FormId::BTSTS_f_bit4: return use(TestFileBit<true>{}), true;
    case FormId::BTST_C_Ws_bit4: return use(TestBit<true, false>{}), true;
    case FormId::BTST_Z_Ws_bit4: return use(TestBit<false, false>{}), true;
    case FormId::BTSTS_C_Ws_bit4: return use(TestBit<true, true>{}), true;
    case FormId::BTSTS_Z_Ws_bit4: return use(TestBit<false, true>{}), true;
    case FormId::BTST_C_Ws_Wb: return use(TestBitByW<true>{}), true;
    case FormId::BTST_Z_Ws_Wb: return use(TestBitByW<false>{}), true;
    case FormId::BSW_C_Ws_Wb: return use(WriteBit<true>{}), true;
    case FormId::BSW_Z_Ws_Wb: return use(WriteBit<false>{}), true;
    case FormId::BTSS_f_bit4: return use(SkipOnFileBit<true>{}), true;
    case FormId::BTSC_f_bit4: return use(SkipOnFileBit<false>{}), true;
    case FormId::BTSS_Ws_bit4: return use(SkipOnBit<true>{}), true;
    case FormId::BTSC_Ws_bit4: return use(SkipOnBit<false>{}), true;
    // clang-format on
    default:
        return false;
    }
}

}  // namespace puckloop::dspic
