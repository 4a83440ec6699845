#pragma once
// Moving data over any domain (words.h): MOV in all its addressing modes, double words, the stack, frames.

#include "emu/dspic/machine/execute/handlers.h"

namespace puckloop::dspic {

/// PUSH Wn and POP Wn as the interpreter does them: MOV Wn,[W15++] and MOV [--W15],Wn.
struct PushW {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape) {
        d.push(d.whole(op->s));
        return op + 1;
    }
};
struct PopW {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape) {
        d.set_whole(op->d, d.pop());
        return op + 1;
    }
};
struct Move {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        d.destination(op, shape, d.source(op, shape));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_base(op, form, word);
        const Ea from = bind_source(op, form, word, 'g', op.byte ? 1 : 2);
        const Ea to = bind_destination(op, form, word, 'h', op.byte ? 1 : 2);
        op.base = pick<Move, true, kMoveModes, kMoveModes>(op);
        constexpr std::uint32_t kPostIncrement = 3;
        constexpr std::uint32_t kPreDecrement = 4;
        if (op.byte) return;
        if (from == Ea::Direct && op.d == 15 && form.field('h', word) == kPostIncrement && op.s != 15)
            op.base = pick<PushW, false, kNone, kNone>(op);
        if (to == Ea::Direct && op.s == 15 && form.field('g', word) == kPreDecrement)
            op.base = pick<PopW, false, kNone, kNone>(op);
    }
};
/// #lit8 and #lit16 to Wnd.
template <bool Byte>
struct MoveLiteral {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape) {
        d.put(op->d, Byte, d.value(op->k));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        op.k = static_cast<std::uint16_t>(form.field('k', word));
        bind_w(op, form, word);
        op.base = pick<MoveLiteral, false, kNone, kNone>(op);
    }
};
/// MOV f and MOV f,WREG set N and Z; the first writes f back, which a register with side effects notices.
template <bool ToFile>
struct MoveFile {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        const auto value = d.moved(shape.byte, d.load(d.address(op->k), shape.byte));
        if constexpr (ToFile)
            d.store(d.address(op->k), shape.byte, value);
        else
            d.put(0, shape.byte, value);
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        op.k = static_cast<std::uint16_t>(form.field('f', word));
        if (!ToFile) sets(op, 0);
        op.base = pick<MoveFile, true, kNone, kNone>(op);
    }
};
struct MoveWreg {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        d.store(d.address(op->k), shape.byte, d.part(0, shape.byte));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        op.k = static_cast<std::uint16_t>(form.field('f', word));
        op.base = pick<MoveWreg, true, kNone, kNone>(op);
    }
};
/// MOV f,Wnd and MOV Wns,f: any word of the lower 64 KB.
struct Load {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape) {
        d.set_whole(op->d, d.load(d.address(op->k), false));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        op.k = static_cast<std::uint16_t>(form.field('f', word) << 1);
        bind_w(op, form, word);
        op.base = pick<Load, false, kNone, kNone>(op);
    }
};
struct Store {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape) {
        d.store(d.address(op->k), false, d.whole(op->s));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        op.k = static_cast<std::uint16_t>(form.field('f', word) << 1);
        op.s = static_cast<std::uint8_t>(form.field('s', word));
        op.base = pick<Store, false, kNone, kNone>(op);
    }
};

/// [Wn+literal]: the signed ten-bit literal counts words in word forms.
inline void bind_displacement(Op& op, const Form& form, std::uint32_t word) {
    int offset = static_cast<int>(form.field('k', word));
    if (offset & 0x200) offset -= 0x400;
    op.k = static_cast<std::uint16_t>(op.byte ? offset : offset * 2);
    op.s = static_cast<std::uint8_t>(form.field('s', word));
    op.d = static_cast<std::uint8_t>(form.field('d', word));
}
/// `PerhapsStack`: false in the interpreter's handlers for other pointers than W15.
template <bool PerhapsStack>
struct LoadDisplaced {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        d.put(op->d, shape.byte, d.load(d.displaced(op->s, op->k, PerhapsStack), shape.byte));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_displacement(op, form, word);
        op.uses |= 0x10001u << op.s;
        sets(op, op.d);
        op.base = op.s == 15 ? pick<LoadDisplaced, true, kNone, kNone>(op)
                             : pick<LoadDisplaced<false>, true, kNone, kNone>(op);
    }
};
template <bool PerhapsStack>
struct StoreDisplaced {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        d.store(d.displaced(op->d, op->k, PerhapsStack), shape.byte, d.part(op->s, shape.byte));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_displacement(op, form, word);
        op.uses |= 0x10000u << op.d;
        op.base = op.d == 15 ? pick<StoreDisplaced, true, kNone, kNone>(op)
                             : pick<StoreDisplaced<false>, true, kNone, kNone>(op);
    }
};

/// Double words: the low word lives at the lower address and in the even register; steps are 4 bytes.
struct LoadDouble {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape shape) {
        if (shape.source == Ea::Direct) {
            const auto low = d.whole(op->s);
            const auto high = d.whole(op->s + 1);
            d.set_whole(op->d, low);
            d.set_whole(op->d + 1, high);
        } else {
            const auto ea = d.source_ea(op, false);
            const auto low = d.load(ea, false);
            const auto high = d.load(d.next_word(ea), false);
            d.set_whole(op->d, low);
            d.set_whole(op->d + 1, high);
        }
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        bind_source(op, form, word, 'p', 4);
        op.d = static_cast<std::uint8_t>(form.field('d', word) * 2);
        sets(op, op.d);
        sets(op, op.d + 1);
        op.base = pick<LoadDouble, false, kDirectOrIndirect, kNone>(op);
    }
};
struct StoreDouble {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape) {
        const auto low = d.whole(op->s);
        const auto high = d.whole(op->s + 1);
        const auto ea = d.destination_ea(op, true);  // never bit-reversed
        d.store(ea, false, low);
        d.store(d.next_word(ea), false, high);
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        op.s = static_cast<std::uint8_t>(form.field('s', word) * 2);
        bind_destination(op, form, word, 'q', 4);
        op.base = pick<StoreDouble, false, kNone, kNone>(op);
    }
};

struct PushFile {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape) {
        d.push(d.load(d.address(op->k), false));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        op.k = static_cast<std::uint16_t>(form.field('f', word) << 1);
        op.writes |= 1u << 15;
        op.base = pick<PushFile, false, kNone, kNone>(op);
    }
};
struct PopFile {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape) {
        d.store(d.address(op->k), false, d.pop());
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        op.k = static_cast<std::uint16_t>(form.field('f', word) << 1);
        op.uses |= 1u << 15;
        op.base = pick<PopFile, false, kNone, kNone>(op);
    }
};

struct Link {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape) {
        d.push(d.whole(14));
        d.set_whole(14, d.whole(15));
        d.set_whole(15, d.plus(d.whole(15), op->k));
        return op + 1;
    }
    static void bind(Op& op, const Form& form, std::uint32_t word) {
        op.k = static_cast<std::uint16_t>(form.field('k', word) << 1);
        initialises(op, 14);
        op.base = pick<Link, false, kNone, kNone>(op);
    }
};
struct Unlink {
    template <class D, class Shape>
    static const Op* run(D& d, const Op* op, Shape) {
        d.set_whole(15, d.whole(14));
        d.set_whole(14, d.pop());
        return op + 1;
    }
    static void bind(Op& op, const Form&, std::uint32_t) {
        op.uses |= 0x10001u << 14;
        op.base = pick<Unlink, false, kNone, kNone>(op);
    }
};

/// Calls `use` with the semantics of a form of this file; false if it is none.
template <class Use>
bool with_move(FormId id, Use use) {
    switch (id) {
        // clang-format off
    case FormId::MOV_Ws_Wd: return use(Move{}), true;
    case FormId::MOV_B_lit8_Wnd: return use(MoveLiteral<true>{}), true;
    case FormId::MOV_lit16_Wnd: return use(MoveLiteral<false>{}), true;
    case FormId::MOV_f: return use(MoveFile<true>{}), true;
    case FormId::MOV_f_WREG: return use(MoveFile<false>{}), true;
    case FormId::MOV_WREG_f: return use(MoveWreg{}), true;
    case FormId::MOV_f_Wnd: return use(Load{}), true;
    case FormId::MOV_Wns_f: return use(Store{}), true;
    case FormId::MOV_WsOffset_Wnd: return use(LoadDisplaced<true>{}), true;
    case FormId::MOV_Wns_WdOffset: return use(StoreDisplaced<true>{}), true;
    case FormId::MOV_D_Ws_Wnd: return use(LoadDouble{}), true;
    case FormId::MOV_D_Wns_Wd: return use(StoreDouble{}), true;
    case FormId::PUSH_f: return use(PushFile{}), true;
    case FormId::POP_f: return use(PopFile{}), true;
    case FormId::LNK_lit14: return use(Link{}), true;
    case FormId::ULNK: return use(Unlink{}), true;
    // clang-format on
    default:
        return false;
    }
}

}  // namespace puckloop::dspic
