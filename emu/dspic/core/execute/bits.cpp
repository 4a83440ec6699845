// Single bits: set, clear, toggle, test, write, skip. The f forms are byte accesses; the word's bit number is
// the index in the byte plus 8 for an odd address.

#include "emu/dspic/core/machine.h"

namespace puckloop::dspic {

namespace {

enum class Action { Set, Clear, Toggle };
template <Action What>
std::uint16_t changed(std::uint16_t value, std::uint16_t mask) {
    if constexpr (What == Action::Set) return static_cast<std::uint16_t>(value | mask);
    if constexpr (What == Action::Clear) return static_cast<std::uint16_t>(value & ~mask);
    return static_cast<std::uint16_t>(value ^ mask);
}

template <Action What, bool Byte>
const Op* change_direct(Machine& m, const Op* op) {
    put_w<Byte>(m, op->s, changed<What>(m.st.w[op->s], op->k));
    return op + 1;
}
template <Action What, bool Byte>
const Op* change_indirect(Machine& m, const Op* op) {
    const std::uint16_t ea = source_ea<!Byte>(m, op);
    write_data<Byte>(m, ea, changed<What>(read_data<Byte>(m, ea), op->k));
    return op + 1;
}
template <Action What>
const Op* change_file(Machine& m, const Op* op) {
    write8(m, op->k, changed<What>(read8(m, op->k), op->aux));
    return op + 1;
}

/// C = bit, or Z = not bit.
template <bool ToC>
void test(Machine& m, bool bit) {
    if constexpr (ToC)
        set_flags(m, sr::C, bit ? sr::C : 0u);
    else
        set_flags(m, sr::Z, bit ? 0u : sr::Z);
}

template <bool ToC, bool ThenSet, Ea Source>
const Op* test_bit(Machine& m, const Op* op) {
    if constexpr (Source == Ea::Direct) {
        const std::uint16_t value = m.st.w[op->s];
        test<ToC>(m, value & op->k);
        if constexpr (ThenSet) set_w(m, op->s, value | op->k);
    } else {
        const std::uint16_t ea = source_ea(m, op);
        const std::uint16_t value = read16(m, ea);
        test<ToC>(m, value & op->k);
        if constexpr (ThenSet) write16(m, ea, static_cast<std::uint16_t>(value | op->k));
    }
    return op + 1;
}
template <bool ToC, Ea Source>
const Op* test_bit_by_w(Machine& m, const Op* op) {
    const int bit = m.st.w[op->b] & 15;  // read before the source pointer moves
    test<ToC>(m, source<false, Source>(m, op) >> bit & 1);
    return op + 1;
}
template <bool ThenSet>
const Op* test_file(Machine& m, const Op* op) {
    const std::uint16_t value = read8(m, op->k);
    test<false>(m, value & op->aux);
    if constexpr (ThenSet) write8(m, op->k, static_cast<std::uint16_t>(value | op->aux));
    return op + 1;
}

/// BSW.C writes C, BSW.Z writes the complement of Z.
template <bool FromC, Ea Source>
const Op* write_bit(Machine& m, const Op* op) {
    const auto mask = static_cast<std::uint16_t>(1u << (m.st.w[op->b] & 15));
    const bool bit = FromC ? m.st.sr & sr::C : !(m.st.sr & sr::Z);
    const auto put = [&](std::uint16_t v) { return static_cast<std::uint16_t>(bit ? v | mask : v & ~mask); };
    if constexpr (Source == Ea::Direct) {
        set_w(m, op->s, put(m.st.w[op->s]));
    } else {
        const std::uint16_t ea = source_ea(m, op);
        write16(m, ea, put(read16(m, ea)));
    }
    return op + 1;
}

template <bool IfSet, Ea Source>
const Op* skip_on_bit(Machine& m, const Op* op) {
    const bool bit = source<false, Source>(m, op) & op->k;
    return bit == IfSet ? skip_next(m, op) : op + 1;
}
template <bool IfSet>
const Op* skip_on_file(Machine& m, const Op* op) {
    const bool bit = read8(m, op->k) & op->aux;
    return bit == IfSet ? skip_next(m, op) : op + 1;
}

void file_bit(Op& op, const Form& form, std::uint32_t word) {
    op.k = static_cast<std::uint16_t>(form.field('f', word));
    op.aux = static_cast<std::uint8_t>(1u << form.field('b', word));
}
template <Action What>
void bind_change(Op& op, const Form& form, std::uint32_t word) {
    const bool byte = form.field('B', word) != 0;
    const bool direct = bind_source(op, form, word, 'p', byte ? 1 : 2) == Ea::Direct;
    op.k = static_cast<std::uint16_t>(1u << form.field('b', word));
    if (direct) {
        sets(op, op.s);
        op.base = byte ? &change_direct<What, true> : &change_direct<What, false>;
    } else {
        op.base = byte ? &change_indirect<What, true> : &change_indirect<What, false>;
    }
}
void bind_ws(Op& op, const Form& form, std::uint32_t word, Handler direct, Handler indirect, bool writes) {
    const bool is_direct = bind_source(op, form, word, 'p', 2) == Ea::Direct;
    if (form.has_field('b')) op.k = static_cast<std::uint16_t>(1u << form.field('b', word));
    if (form.has_field('w')) op.b = static_cast<std::uint8_t>(form.field('w', word));
    if (is_direct && writes) sets(op, op.s);
    op.base = is_direct ? direct : indirect;
}

}  // namespace

bool bind_bits(Op& op, const Form& form, std::uint32_t word) {
    constexpr auto kDirect = Ea::Direct;
    constexpr auto kIndirect = Ea::Indirect;
    switch (form.id) {
    case FormId::BSET_Ws_bit4:
        bind_change<Action::Set>(op, form, word);
        return true;
    case FormId::BCLR_Ws_bit4:
        bind_change<Action::Clear>(op, form, word);
        return true;
    case FormId::BTG_Ws_bit4:
        bind_change<Action::Toggle>(op, form, word);
        return true;
    case FormId::BSET_f_bit4:
    case FormId::BCLR_f_bit4:
    case FormId::BTG_f_bit4:
        file_bit(op, form, word);
        op.base = form.id == FormId::BSET_f_bit4   ? &change_file<Action::Set>
                  : form.id == FormId::BCLR_f_bit4 ? &change_file<Action::Clear>
                                                   : &change_file<Action::Toggle>;
        return true;
    case FormId::BTST_f_bit4:
    case FormId::BTSTS_f_bit4:
        file_bit(op, form, word);
        op.base = form.id == FormId::BTSTS_f_bit4 ? &test_file<true> : &test_file<false>;
        return true;
    case FormId::BTSS_f_bit4:
    case FormId::BTSC_f_bit4:
        file_bit(op, form, word);
        op.base = form.id == FormId::BTSS_f_bit4 ? &skip_on_file<true> : &skip_on_file<false>;
        return true;
    case FormId::BTST_C_Ws_bit4:
        bind_ws(op, form, word, &test_bit<true, false, kDirect>, &test_bit<true, false, kIndirect>, false);
        return true;
    case FormId::BTST_Z_Ws_bit4:
        bind_ws(op, form, word, &test_bit<false, false, kDirect>, &test_bit<false, false, kIndirect>, false);
        return true;
    case FormId::BTSTS_C_Ws_bit4:
        bind_ws(op, form, word, &test_bit<true, true, kDirect>, &test_bit<true, true, kIndirect>, true);
        return true;
    case FormId::BTSTS_Z_Ws_bit4:
        bind_ws(op, form, word, &test_bit<false, true, kDirect>, &test_bit<false, true, kIndirect>, true);
        return true;
    case FormId::BTST_C_Ws_Wb:
        bind_ws(op, form, word, &test_bit_by_w<true, kDirect>, &test_bit_by_w<true, kIndirect>, false);
        return true;
    case FormId::BTST_Z_Ws_Wb:
        bind_ws(op, form, word, &test_bit_by_w<false, kDirect>, &test_bit_by_w<false, kIndirect>, false);
        return true;
    case FormId::BSW_C_Ws_Wb:
        bind_ws(op, form, word, &write_bit<true, kDirect>, &write_bit<true, kIndirect>, true);
        return true;
    case FormId::BSW_Z_Ws_Wb:
        bind_ws(op, form, word, &write_bit<false, kDirect>, &write_bit<false, kIndirect>, true);
        return true;
    case FormId::BTSS_Ws_bit4:
        bind_ws(op, form, word, &skip_on_bit<true, kDirect>, &skip_on_bit<true, kIndirect>, false);
        return true;
    case FormId::BTSC_Ws_bit4:
        bind_ws(op, form, word, &skip_on_bit<false, kDirect>, &skip_on_bit<false, kIndirect>, false);
        return true;
    default:
        return false;
    }
}

}  // namespace puckloop::dspic
