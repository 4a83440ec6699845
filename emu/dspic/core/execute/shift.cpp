// Shifts and rotates by one, shifts by many, sign and zero extension, byte swapping, bit searching.

#include "emu/dspic/core/execute/one_operand.h"

namespace puckloop::dspic {

namespace {

template <bool Byte>
constexpr std::uint32_t kTop = Byte ? 0x80 : 0x8000;

/// By one bit: C is the bit shifted out; OV and DC stay.
template <bool Byte>
std::uint32_t shifted(Machine& m, std::uint32_t result, bool out) {
    set_flags(m, sr::C | sr::N | sr::Z, nz<Byte>(result) | (out ? sr::C : 0u));
    return result;
}
template <bool Byte>
std::uint32_t rotated(Machine& m, std::uint32_t result) {  // not through C: C stays
    set_flags(m, sr::N | sr::Z, nz<Byte>(result));
    return result;
}

struct Sl {
    template <bool Byte>
    static std::uint32_t apply(Machine& m, std::uint32_t s) {
        return shifted<Byte>(m, s << 1, s & kTop<Byte>);
    }
};
struct Lsr {
    template <bool Byte>
    static std::uint32_t apply(Machine& m, std::uint32_t s) {
        return shifted<Byte>(m, s >> 1, s & 1);
    }
};
struct Asr {
    template <bool Byte>
    static std::uint32_t apply(Machine& m, std::uint32_t s) {
        return shifted<Byte>(m, s >> 1 | (s & kTop<Byte>), s & 1);
    }
};
struct Rlnc {
    template <bool Byte>
    static std::uint32_t apply(Machine& m, std::uint32_t s) {
        return rotated<Byte>(m, s << 1 | (s & kTop<Byte> ? 1u : 0u));
    }
};
struct Rlc {
    template <bool Byte>
    static std::uint32_t apply(Machine& m, std::uint32_t s) {
        return shifted<Byte>(m, s << 1 | (m.st.sr & sr::C), s & kTop<Byte>);
    }
};
struct Rrnc {
    template <bool Byte>
    static std::uint32_t apply(Machine& m, std::uint32_t s) {
        return rotated<Byte>(m, s >> 1 | (s & 1 ? kTop<Byte> : 0u));
    }
};
struct Rrc {
    template <bool Byte>
    static std::uint32_t apply(Machine& m, std::uint32_t s) {
        return shifted<Byte>(m, s >> 1 | (m.st.sr & sr::C ? kTop<Byte> : 0u), s & 1);
    }
};

/// By many bits, words only: C stays. Counts of 16 to 31 shift everything out.
enum class Many { Left, Logical, Arithmetic };
template <Many Kind, Ea Count>
const Op* many_bits(Machine& m, const Op* op) {
    const std::uint32_t value = m.st.w[op->b];
    const int count = Count == Ea::Literal ? op->k : m.st.w[op->s] & 31;
    std::uint32_t result = 0;
    if constexpr (Kind == Many::Left) result = count > 15 ? 0 : value << count;
    if constexpr (Kind == Many::Logical) result = value >> count;
    if constexpr (Kind == Many::Arithmetic)
        result = static_cast<std::uint32_t>(static_cast<std::int16_t>(value) >> count) & 0xFFFF;
    set_flags(m, sr::N | sr::Z, nz<false>(result));
    set_w(m, op->d, result);
    return op + 1;
}

template <bool Signed, Ea Source>
const Op* extend(Machine& m, const Op* op) {
    const std::uint16_t s = source<true, Source>(m, op);
    const auto result = static_cast<std::uint16_t>(Signed ? static_cast<std::int8_t>(s) : s);
    const std::uint32_t flags = nz<false>(result);
    set_flags(m, sr::C | sr::N | sr::Z, flags | (flags & sr::N ? 0u : sr::C));
    set_w(m, op->d, result);
    return op + 1;
}

const Op* swap_bytes(Machine& m, const Op* op) {
    const std::uint32_t w = m.st.w[op->s];
    set_w(m, op->s, w << 8 | w >> 8);
    return op + 1;
}
const Op* swap_nibbles(Machine& m, const Op* op) {
    const std::uint32_t w = m.st.w[op->s];
    put_w<true>(m, op->s, (w << 4 & 0xF0) | (w >> 4 & 0x0F));
    return op + 1;
}
const Op* exchange(Machine& m, const Op* op) {
    const std::uint16_t s = m.st.w[op->s];
    const std::uint16_t d = m.st.w[op->d];
    set_w(m, op->s, d);
    set_w(m, op->d, s);
    return op + 1;
}

/// Decimal adjust of the low byte after an addition of packed BCD; C only ever gets set.
const Op* decimal_adjust(Machine& m, const Op* op) {
    std::uint32_t t = m.st.w[op->s] & 0xFF;
    if ((t & 0xF) > 9 || m.st.sr & sr::DC) t += 0x06;
    if (t > 0x9F || m.st.sr & sr::C) t += 0x60;
    if (t > 0xFF) set_flags(m, sr::C, sr::C);
    put_w<true>(m, op->s, t);
    return op + 1;
}

enum class Search { FirstLeft, FirstRight, BitChangeLeft };
template <Search Kind, Ea Source>
const Op* search(Machine& m, const Op* op) {
    const std::uint16_t s = source<false, Source>(m, op);
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
    set_flags(m, sr::C, none ? sr::C : 0u);
    set_w(m, op->d, static_cast<std::uint32_t>(result));
    return op + 1;
}

template <Many Kind>
void bind_many(Op& op, const Form& form, std::uint32_t word) {
    op.b = static_cast<std::uint8_t>(form.field('w', word));
    op.d = static_cast<std::uint8_t>(form.field('d', word));
    sets(op, op.d);
    if (form.has_field('k')) {
        op.k = static_cast<std::uint16_t>(form.field('k', word));
        op.base = &many_bits<Kind, Ea::Literal>;
    } else {
        op.s = static_cast<std::uint8_t>(form.field('s', word));
        op.base = &many_bits<Kind, Ea::Direct>;
    }
}

/// Ws,Wnd forms with one instance for the direct and one for the indirect source.
void bind_to_w(Op& op, const Form& form, std::uint32_t word, int size, Handler direct, Handler indirect) {
    const Ea from = bind_source(op, form, word, 'p', size);
    op.d = static_cast<std::uint8_t>(form.field('d', word));
    sets(op, op.d);
    op.base = from == Ea::Direct ? direct : indirect;
}

}  // namespace

bool bind_shift(Op& op, const Form& form, std::uint32_t word) {
    switch (form.id) {
        // clang-format off
#define GROUP(NAME, OPERATION)                                                                       \
    case FormId::NAME##_f: case FormId::NAME##_f_WREG: case FormId::NAME##_Ws_Wd:                    \
        return bind_one_operand<OPERATION>(op, form, word);
    GROUP(SL, Sl) GROUP(LSR, Lsr) GROUP(ASR, Asr) GROUP(RLNC, Rlnc) GROUP(RLC, Rlc) GROUP(RRNC, Rrnc)
    GROUP(RRC, Rrc)
#undef GROUP
    case FormId::SL_Wb_lit4_Wnd: case FormId::SL_Wb_Wns_Wnd:
        bind_many<Many::Left>(op, form, word); return true;
    case FormId::LSR_Wb_lit4_Wnd: case FormId::LSR_Wb_Wns_Wnd:
        bind_many<Many::Logical>(op, form, word); return true;
    case FormId::ASR_Wb_lit4_Wnd: case FormId::ASR_Wb_Wns_Wnd:
        bind_many<Many::Arithmetic>(op, form, word); return true;
    case FormId::FF1L_Ws_Wnd:
        bind_to_w(op, form, word, 2, &search<Search::FirstLeft, Ea::Direct>,
                  &search<Search::FirstLeft, Ea::Indirect>);
        return true;
    case FormId::FF1R_Ws_Wnd:
        bind_to_w(op, form, word, 2, &search<Search::FirstRight, Ea::Direct>,
                  &search<Search::FirstRight, Ea::Indirect>);
        return true;
    case FormId::FBCL_Ws_Wnd:
        bind_to_w(op, form, word, 2, &search<Search::BitChangeLeft, Ea::Direct>,
                  &search<Search::BitChangeLeft, Ea::Indirect>);
        return true;
    case FormId::SE_Ws_Wnd:
        bind_to_w(op, form, word, 1, &extend<true, Ea::Direct>, &extend<true, Ea::Indirect>);
        return true;
    case FormId::ZE_Ws_Wnd:
        bind_to_w(op, form, word, 1, &extend<false, Ea::Direct>, &extend<false, Ea::Indirect>);
        return true;
        // clang-format on
    case FormId::EXCH_Wns_Wnd:
        op.s = static_cast<std::uint8_t>(form.field('s', word));
        op.d = static_cast<std::uint8_t>(form.field('d', word));
        sets(op, op.s);
        sets(op, op.d);
        op.base = &exchange;
        return true;
    case FormId::SWAP_Wn:
    case FormId::DAW_B_Wn:
        op.s = static_cast<std::uint8_t>(form.field('s', word));
        sets(op, op.s);
        op.base = form.id == FormId::DAW_B_Wn  ? &decimal_adjust
                  : form.field('B', word) != 0 ? &swap_nibbles
                                               : &swap_bytes;
        return true;
    default:
        return false;
    }
}

}  // namespace puckloop::dspic
