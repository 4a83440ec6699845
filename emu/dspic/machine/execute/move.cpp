// What of the moves is written for the interpreter alone: the shadow set, table reads and writes.

#include "emu/dspic/machine/execute/moves.h"

namespace puckloop::dspic {

namespace {

constexpr std::uint16_t kShadowFlags = sr::C | sr::Z | sr::OV | sr::N | sr::DC;
const Op* push_shadow(Machine& m, const Op* op) {
    for (std::size_t i = 0; i < 4; ++i)
        m.st.shadow_w[i] = m.st.w[i];
    m.st.shadow_sr = m.st.sr & kShadowFlags;
    return op + 1;
}
const Op* pop_shadow(Machine& m, const Op* op) {
    for (std::size_t i = 0; i < 4; ++i)
        m.st.w[i] = m.st.shadow_w[i];
    set_flags(m, kShadowFlags, m.st.shadow_sr & kShadowFlags);
    return op + 1;
}

/// TBLPAG:Wn; bit 0 only chooses the byte. Reading what is not there is an address error.
template <bool High, bool Byte, Ea Destination>
const Op* table_read(Machine& m, const Op* op) {
    const std::uint16_t ea = source_ea<!Byte>(m, op);
    bool implemented = false;
    const std::uint32_t word =
        read_program(m, std::uint32_t{m.st.tblpag} << 16 | (ea & 0xFFFEu), &implemented);
    if (!implemented) raise_trap(m, Trap::AddressError);
    std::uint32_t value = High ? word >> 16 : word & 0xFFFF;
    if constexpr (Byte) value = value >> (8 * (ea & 1)) & 0xFF;
    destination<Byte, Destination>(m, op, value);
    return op + 1;
}
template <bool High, bool Byte, Ea Source>
const Op* write_table(Machine& m, const Op* op) {
    const std::uint16_t value = source<Byte, Source>(m, op);
    const std::uint16_t ea = destination_ea<!Byte>(m, op);
    table_write(m, std::uint32_t{m.st.tblpag} << 16 | ea, High, Byte, value);
    return op + 1;
}

template <bool High>
void bind_table_read(Op& op, const Form& form, std::uint32_t word) {
    const bool byte = form.field('B', word) != 0;
    bind_source(op, form, word, 'p', byte ? 1 : 2);
    const Ea to = bind_destination(op, form, word, 'q', byte ? 1 : 2);
    if (to == Ea::Direct)
        op.base = byte ? &table_read<High, true, Ea::Direct> : &table_read<High, false, Ea::Direct>;
    else
        op.base = byte ? &table_read<High, true, Ea::Indirect> : &table_read<High, false, Ea::Indirect>;
}
template <bool High>
void bind_table_write(Op& op, const Form& form, std::uint32_t word) {
    const bool byte = form.field('B', word) != 0;
    const Ea from = bind_source(op, form, word, 'p', byte ? 1 : 2);
    bind_destination(op, form, word, 'q', byte ? 1 : 2);
    if (from == Ea::Direct)
        op.base = byte ? &write_table<High, true, Ea::Direct> : &write_table<High, false, Ea::Direct>;
    else
        op.base = byte ? &write_table<High, true, Ea::Indirect> : &write_table<High, false, Ea::Indirect>;
}

}  // namespace

bool bind_move(Op& op, const Form& form, std::uint32_t word) {
    switch (form.id) {
    case FormId::PUSH_S:
        op.base = &push_shadow;
        return true;
    case FormId::POP_S:
        for (int i = 0; i < 4; ++i)
            initialises(op, i);
        op.base = &pop_shadow;
        return true;
    case FormId::TBLRDL_Ws_Wd:
        bind_table_read<false>(op, form, word);
        return true;
    case FormId::TBLRDH_Ws_Wd:
        bind_table_read<true>(op, form, word);
        return true;
    case FormId::TBLWTL_Ws_Wd:
        bind_table_write<false>(op, form, word);
        return true;
    case FormId::TBLWTH_Ws_Wd:
        bind_table_write<true>(op, form, word);
        return true;
    default:
        return with_move(form.id, [&](auto semantics) { semantics.bind(op, form, word); });
    }
}

}  // namespace puckloop::dspic
