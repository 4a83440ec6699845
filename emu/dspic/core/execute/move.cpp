// Moving data: MOV in all its addressing modes, double words, the stack, the shadow set, table reads and
// writes.

#include "emu/dspic/core/machine.h"

namespace puckloop::dspic {

namespace {

template <bool Byte, Ea Source, Ea Destination>
const Op* move(Machine& m, const Op* op) {
    const std::uint16_t s = source<Byte, Source>(m, op);
    destination<Byte, Destination>(m, op, s);
    return op + 1;
}
const Op* push_w(Machine& m, const Op* op) {  // MOV Wn,[W15++]
    push(m, m.st.w[op->s]);
    return op + 1;
}
const Op* pop_w(Machine& m, const Op* op) {  // MOV [--W15],Wn
    set_w(m, op->d, pop(m));
    return op + 1;
}
template <bool Byte>
const Op* move_literal(Machine& m, const Op* op) {
    put_w<Byte>(m, op->d, op->k);
    return op + 1;
}
/// MOV f and MOV f,WREG set N and Z; the first writes f back, which a register with side effects notices.
template <bool Byte, bool ToFile>
const Op* move_file(Machine& m, const Op* op) {
    const std::uint16_t value = read_data<Byte>(m, op->k);
    set_flags(m, sr::N | sr::Z, nz<Byte>(value));
    if constexpr (ToFile)
        write_data<Byte>(m, op->k, value);
    else
        put_w<Byte>(m, 0, value);
    return op + 1;
}
template <bool Byte>
const Op* move_wreg(Machine& m, const Op* op) {
    write_data<Byte>(m, op->k, m.st.w[0]);
    return op + 1;
}
const Op* load(Machine& m, const Op* op) {
    set_w(m, op->d, read16(m, op->k));
    return op + 1;
}
const Op* store(Machine& m, const Op* op) {
    write16(m, op->k, m.st.w[op->s]);
    return op + 1;
}

/// [Wn + literal]: never modulo, but through W15 the stack limits hold.
template <bool Byte, bool Stack>
const Op* load_offset(Machine& m, const Op* op) {
    const auto ea = static_cast<std::uint16_t>(m.st.w[op->s] + op->k);
    if constexpr (Stack) check_stack(m, ea);
    put_w<Byte>(m, op->d, read_data<Byte>(m, ea));
    return op + 1;
}
template <bool Byte, bool Stack>
const Op* store_offset(Machine& m, const Op* op) {
    const auto ea = static_cast<std::uint16_t>(m.st.w[op->d] + op->k);
    if constexpr (Stack) check_stack(m, ea);
    write_data<Byte>(m, ea, m.st.w[op->s]);
    return op + 1;
}

/// Double words: the low word lives at the lower address and in the even register; steps are 4 bytes.
template <Ea Source>
const Op* load_double(Machine& m, const Op* op) {
    if constexpr (Source == Ea::Direct) {
        const std::uint16_t low = m.st.w[op->s];
        const std::uint16_t high = m.st.w[op->s + 1u];
        set_w(m, op->d, low);
        set_w(m, op->d + 1, high);
    } else {
        const std::uint16_t ea = source_ea(m, op);
        const std::uint16_t low = read16(m, ea);
        const std::uint16_t high = read16(m, static_cast<std::uint16_t>(ea + 2));
        set_w(m, op->d, low);
        set_w(m, op->d + 1, high);
    }
    return op + 1;
}
const Op* store_double(Machine& m, const Op* op) {
    const std::uint16_t low = m.st.w[op->s];
    const std::uint16_t high = m.st.w[op->s + 1u];
    const std::uint16_t ea = destination_ea<false>(m, op);
    write16(m, ea, low);
    write16(m, static_cast<std::uint16_t>(ea + 2), high);
    return op + 1;
}

const Op* push_file(Machine& m, const Op* op) {
    push(m, read16(m, op->k));
    return op + 1;
}
const Op* pop_file(Machine& m, const Op* op) {
    write16(m, op->k, pop(m));
    return op + 1;
}

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

const Op* link_frame(Machine& m, const Op* op) {
    push(m, m.st.w[14]);
    m.st.w[14] = m.st.w[15];
    m.st.w[15] = static_cast<std::uint16_t>(m.st.w[15] + op->k);
    return op + 1;
}
const Op* unlink_frame(Machine& m, const Op* op) {
    m.st.w[15] = m.st.w[14] & 0xFFFE;
    m.st.w[14] = pop(m);
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

std::uint8_t field8(const Form& form, std::uint32_t word, char letter) {
    return static_cast<std::uint8_t>(form.field(letter, word));
}

template <bool Byte>
Handler pick_move(Ea from, Ea to) {
    constexpr auto D = Ea::Direct;
    constexpr auto I = Ea::Indirect;
    constexpr auto O = Ea::Offset;
    if (from == D) return to == D ? &move<Byte, D, D> : to == I ? &move<Byte, D, I> : &move<Byte, D, O>;
    if (from == I) return to == D ? &move<Byte, I, D> : to == I ? &move<Byte, I, I> : &move<Byte, I, O>;
    return to == D ? &move<Byte, O, D> : to == I ? &move<Byte, O, I> : &move<Byte, O, O>;
}

void bind_ws_wd(Op& op, const Form& form, std::uint32_t word) {
    const bool byte = form.field('B', word) != 0;
    op.b = field8(form, word, 'w');
    const Ea from = bind_source(op, form, word, 'g', byte ? 1 : 2);
    const Ea to = bind_destination(op, form, word, 'h', byte ? 1 : 2);
    op.base = byte ? pick_move<true>(from, to) : pick_move<false>(from, to);
    constexpr std::uint32_t kPostIncrement = 3;
    constexpr std::uint32_t kPreDecrement = 4;
    if (!byte && from == Ea::Direct && op.d == 15 && form.field('h', word) == kPostIncrement && op.s != 15)
        op.base = &push_w;
    if (!byte && to == Ea::Direct && op.s == 15 && form.field('g', word) == kPreDecrement) op.base = &pop_w;
}

/// [Wn+literal]: the signed ten-bit literal counts words in word forms.
std::uint16_t offset_literal(const Form& form, std::uint32_t word, bool byte) {
    int offset = static_cast<int>(form.field('k', word));
    if (offset & 0x200) offset -= 0x400;
    return static_cast<std::uint16_t>(byte ? offset : offset * 2);
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

void stack_pointer(Op& op, bool read) {
    if (read) op.uses |= 1u << 15;
    op.writes |= 1u << 15;
}

}  // namespace

bool bind_move(Op& op, const Form& form, std::uint32_t word) {
    const bool byte = form.field('B', word) != 0;
    switch (form.id) {
    case FormId::MOV_Ws_Wd:
        bind_ws_wd(op, form, word);
        return true;
    case FormId::MOV_WREG_f:
        op.k = static_cast<std::uint16_t>(form.field('f', word));
        op.base = byte ? &move_wreg<true> : &move_wreg<false>;
        return true;
    case FormId::MOV_f:
        op.k = static_cast<std::uint16_t>(form.field('f', word));
        op.base = byte ? &move_file<true, true> : &move_file<false, true>;
        return true;
    case FormId::MOV_f_WREG:
        op.k = static_cast<std::uint16_t>(form.field('f', word));
        sets(op, 0);
        op.base = byte ? &move_file<true, false> : &move_file<false, false>;
        return true;
    case FormId::MOV_B_lit8_Wnd:
    case FormId::MOV_lit16_Wnd:
        op.k = static_cast<std::uint16_t>(form.field('k', word));
        op.d = field8(form, word, 'd');
        sets(op, op.d);
        op.base = form.id == FormId::MOV_B_lit8_Wnd ? &move_literal<true> : &move_literal<false>;
        return true;
    case FormId::MOV_f_Wnd:
        op.k = static_cast<std::uint16_t>(form.field('f', word) << 1);
        op.d = field8(form, word, 'd');
        sets(op, op.d);
        op.base = &load;
        return true;
    case FormId::MOV_Wns_f:
        op.k = static_cast<std::uint16_t>(form.field('f', word) << 1);
        op.s = field8(form, word, 's');
        op.base = &store;
        return true;
    case FormId::MOV_WsOffset_Wnd:
        op.k = offset_literal(form, word, byte);
        op.s = field8(form, word, 's');
        op.d = field8(form, word, 'd');
        op.uses |= 0x10001u << op.s;
        sets(op, op.d);
        if (op.s == 15)
            op.base = byte ? &load_offset<true, true> : &load_offset<false, true>;
        else
            op.base = byte ? &load_offset<true, false> : &load_offset<false, false>;
        return true;
    case FormId::MOV_Wns_WdOffset:
        op.k = offset_literal(form, word, byte);
        op.s = field8(form, word, 's');
        op.d = field8(form, word, 'd');
        op.uses |= 0x10000u << op.d;
        if (op.d == 15)
            op.base = byte ? &store_offset<true, true> : &store_offset<false, true>;
        else
            op.base = byte ? &store_offset<true, false> : &store_offset<false, false>;
        return true;
    case FormId::MOV_D_Ws_Wnd: {
        const Ea from = bind_source(op, form, word, 'p', 4);
        op.d = static_cast<std::uint8_t>(form.field('d', word) * 2);
        sets(op, op.d);
        sets(op, op.d + 1);
        op.base = from == Ea::Direct ? &load_double<Ea::Direct> : &load_double<Ea::Indirect>;
        return true;
    }
    case FormId::MOV_D_Wns_Wd:
        op.s = static_cast<std::uint8_t>(form.field('s', word) * 2);
        bind_destination(op, form, word, 'q', 4);
        op.base = &store_double;
        return true;
    case FormId::PUSH_f:
        op.k = static_cast<std::uint16_t>(form.field('f', word) << 1);
        stack_pointer(op, false);
        op.base = &push_file;
        return true;
    case FormId::POP_f:
        op.k = static_cast<std::uint16_t>(form.field('f', word) << 1);
        op.uses |= 1u << 15;
        op.base = &pop_file;
        return true;
    case FormId::PUSH_S:
        op.base = &push_shadow;
        return true;
    case FormId::POP_S:
        for (int i = 0; i < 4; ++i)
            initialises(op, i);
        op.base = &pop_shadow;
        return true;
    case FormId::LNK_lit14:
        op.k = static_cast<std::uint16_t>(form.field('k', word) << 1);
        initialises(op, 14);
        op.base = &link_frame;
        return true;
    case FormId::ULNK:
        op.uses |= 0x10001u << 14;
        op.base = &unlink_frame;
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
        return false;
    }
}

}  // namespace puckloop::dspic
