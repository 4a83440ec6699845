// The DSP engine: 40-bit accumulators, saturation, rounding, fractional and unsigned multiplication,
// prefetch. Per result R of an accumulator (family reference manual, "DSP engine"):
//   SATx=1: limited to 1.31 (ACCSAT=0) or 9.31 (ACCSAT=1), SAx set if it was; SATx=0: low 40 bits kept, SAx
//   set if bit 39 overflowed. OAx = bits 39:31 differ. SAx stays until software clears it.

#include "emu/dspic/devices/register_bits.h"
#include "emu/dspic/machine/machine.h"

namespace puckloop::dspic {

namespace {

constexpr RegisterBits kINTCON1{"INTCON1"};

constexpr std::int64_t kMax131 = 0x7FFFFFFF;
constexpr std::int64_t kMin131 = -0x80000000LL;
constexpr std::int64_t kMax931 = 0x7FFFFFFFFF;
constexpr std::int64_t kMin931 = -0x8000000000LL;

std::int64_t wrap40(std::int64_t value) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(value) << 24) >> 24;
}

void summarise(Machine& m) {
    std::uint32_t s = m.st.sr & ~std::uint32_t{sr::OAB | sr::SAB};
    if (s & (sr::OA | sr::OB)) s |= sr::OAB;
    if (s & (sr::SA | sr::SB)) s |= sr::SAB;
    m.st.sr = static_cast<std::uint16_t>(s);
}

/// Stores an exact result in accumulator `which` (0 = A) with saturation, flags and traps.
void accumulate(Machine& m, int which, std::int64_t exact) {
    const std::uint16_t control = m.st.corcon;
    const bool saturate = control & (which ? corcon::SATB : corcon::SATA);
    bool limited = false;
    std::int64_t stored = exact;
    if (saturate) {
        const bool wide = control & corcon::ACCSAT;
        const std::int64_t low = wide ? kMin931 : kMin131;
        const std::int64_t high = wide ? kMax931 : kMax131;
        stored = exact < low ? low : exact > high ? high : exact;
        limited = stored != exact;
    } else {
        stored = wrap40(exact);
        limited = stored != exact;
    }
    m.st.acc[static_cast<std::size_t>(which)] = stored;
    const bool over = stored < kMin131 || stored > kMax131;
    const std::uint16_t o = which ? sr::OB : sr::OA;
    const std::uint16_t s = which ? sr::SB : sr::SA;
    m.st.sr = static_cast<std::uint16_t>((m.st.sr & ~o) | (over ? o : 0) | (limited ? s : 0));
    summarise(m);
    if (over || limited) {
        const std::uint16_t enables = m.irq.intcon1();
        const bool overflow_trap = over && enables & (which ? kINTCON1["OVBTE"] : kINTCON1["OVATE"]);
        const bool catastrophe = limited && !saturate && enables & kINTCON1["COVTE"];
        if (overflow_trap || catastrophe) raise_trap(m, Trap::MathError);
    }
}

/// Product of the DSP multiplier: US chooses unsigned inputs, IF=0 doubles it (fractions).
std::int64_t product(const Machine& m, std::uint16_t a, std::uint16_t b) {
    std::int64_t p = 0;
    if (m.st.corcon & corcon::US)
        p = std::int64_t{a} * b;
    else
        p = std::int64_t{static_cast<std::int16_t>(a)} * static_cast<std::int16_t>(b);
    return m.st.corcon & corcon::IF ? p : p * 2;
}

/// Bits 31:16 of a 40-bit value, rounded if asked (RND=1: half up; RND=0: half to even) and, with SATDW,
/// limited to 1.31 first.
std::uint16_t upper_word(const Machine& m, std::int64_t value, bool round) {
    if (round) {
        const bool tie_to_even = !(m.st.corcon & corcon::RND) && (value & 0x1FFFF) == 0x08000;
        if (!tie_to_even) value += 0x8000;
    }
    if (m.st.corcon & corcon::SATDW) {
        if (value > kMax131) return 0x7FFF;
        if (value < kMin131) return 0x8000;
    }
    return static_cast<std::uint16_t>(value >> 16);
}

std::int64_t shift_right(std::int64_t value, int by) {  // negative = left
    return by >= 0 ? value >> by : value * (std::int64_t{1} << -by);
}

// Accumulator operands live in op->aux: bit 0 = accumulator, the rest as each handler states.
int target(const Op* op) {
    return op->aux & 1;
}

const Op* add_accumulators(Machine& m, const Op* op) {
    accumulate(m, target(op), m.st.acc[0] + m.st.acc[1]);
    return op + 1;
}
const Op* subtract_accumulators(Machine& m, const Op* op) {
    const auto a = static_cast<std::size_t>(target(op));
    accumulate(m, target(op), m.st.acc[a] - m.st.acc[a ^ 1]);
    return op + 1;
}
const Op* negate_accumulator(Machine& m, const Op* op) {
    accumulate(m, target(op), -m.st.acc[static_cast<std::size_t>(target(op))]);
    return op + 1;
}

/// LAC, ADD Ws,Acc: the word at bits 31:16, sign extended, shifted by the signed literal in k.
template <bool Add, Ea Source>
const Op* from_word(Machine& m, const Op* op) {
    const auto s = static_cast<std::int16_t>(source<false, Source>(m, op));
    const std::int64_t value = shift_right(std::int64_t{s} * 0x10000, static_cast<std::int16_t>(op->k));
    accumulate(m, target(op), Add ? m.st.acc[static_cast<std::size_t>(target(op))] + value : value);
    return op + 1;
}
template <bool Round, Ea Destination>
const Op* to_word(Machine& m, const Op* op) {
    const std::int64_t value =
        shift_right(m.st.acc[static_cast<std::size_t>(target(op))], static_cast<std::int16_t>(op->k));
    destination<false, Destination>(m, op, upper_word(m, wrap40(value), Round));
    return op + 1;
}
template <bool ByW>
const Op* shift_accumulator(Machine& m, const Op* op) {
    int by = static_cast<std::int16_t>(op->k);
    if constexpr (ByW) {
        by = m.st.w[op->s] & 0x3F;
        if (by & 0x20) by -= 0x40;
        if (by < -16 || by > 16) {
            raise_trap(m, Trap::MathError);
            return op + 1;
        }
    }
    accumulate(m, target(op), shift_right(m.st.acc[static_cast<std::size_t>(target(op))], by));
    return op + 1;
}

// MAC class. k packs iiii (15:12), jjjj (11:8), xx (7:6), yy (5:4), aa (3:2); b and s name the factors.
int x_code(const Op* op) {
    return op->k >> 12;
}
int y_code(const Op* op) {
    return op->k >> 8 & 15;
}
int x_register(const Op* op) {
    return 4 + (op->k >> 6 & 3);
}
int y_register(const Op* op) {
    return 4 + (op->k >> 4 & 3);
}
int write_back(const Op* op) {
    return op->k >> 2 & 3;
}
constexpr int kNoPrefetch = 4;
constexpr int kRegisterOffset = 0xC;
constexpr int kSteps[8] = {0, 2, 4, 6, 0, -6, -4, -2};

std::uint16_t fetch_x(Machine& m, int code) {
    const int reg = code < 8 ? 8 : 9;
    if (code == kRegisterOffset) return read16(m, offset_ea(m, 9, m.st.w[12], false));
    const int step = kSteps[code & 7];
    if (m.special >> reg & 1) return read16(m, special_ea(m, reg, 0, step, false, true));
    const std::uint16_t ea = get_w(m, reg);
    set_w(m, reg, static_cast<std::uint32_t>(ea + step));
    return read16(m, ea);
}
std::uint16_t fetch_y(Machine& m, int code) {
    const int reg = code < 8 ? 10 : 11;
    std::uint16_t ea = get_w(m, reg);
    if (code == kRegisterOffset)
        ea = static_cast<std::uint16_t>(ea + m.st.w[12]);
    else
        set_w(m, reg, modulo_y(m, reg, kSteps[code & 7]));
    // The Y bus reaches Y memory only.
    if (ea < m.device.y_start || ea >= m.device.ram_end) {
        raise_trap(m, Trap::AddressError);
        return 0;
    }
    return read16(m, ea);
}
struct Fetched {
    std::uint16_t x = 0, y = 0;
};
Fetched prefetch(Machine& m, const Op* op) {
    Fetched fetched;
    if (x_code(op) != kNoPrefetch) fetched.x = fetch_x(m, x_code(op));
    if (y_code(op) != kNoPrefetch) fetched.y = fetch_y(m, y_code(op));
    return fetched;
}
void put_prefetched(Machine& m, const Op* op, const Fetched& fetched) {
    if (x_code(op) != kNoPrefetch) set_w(m, x_register(op), fetched.x);
    if (y_code(op) != kNoPrefetch) set_w(m, y_register(op), fetched.y);
}
/// The other accumulator, rounded, to W13 or [W13]+=2.
void store_other(Machine& m, const Op* op, std::int64_t other) {
    if (write_back(op) > 1) return;
    const std::uint16_t value = upper_word(m, other, true);
    if (write_back(op) == 0) {
        set_w(m, 13, value);
    } else {
        const std::uint16_t ea = m.special >> 13 & 1 ? special_ea(m, 13, 0, 2, true, true) : m.st.w[13];
        if (!(m.special >> 13 & 1)) set_w(m, 13, ea + 2u);
        write16(m, ea, value);
    }
}

enum class Mac { Add, Subtract, Load, LoadNegative, Clear, MoveOnly, Distance, AddDistance };
template <Mac Kind, bool WriteBack>
const Op* mac(Machine& m, const Op* op) {
    const auto a = static_cast<std::size_t>(target(op));
    const std::int64_t p = product(m, m.st.w[op->b], m.st.w[op->s]);
    const std::int64_t other = m.st.acc[a ^ 1];
    const Fetched fetched = prefetch(m, op);
    if constexpr (Kind == Mac::Add || Kind == Mac::AddDistance) accumulate(m, target(op), m.st.acc[a] + p);
    if constexpr (Kind == Mac::Subtract) accumulate(m, target(op), m.st.acc[a] - p);
    if constexpr (Kind == Mac::Load || Kind == Mac::Distance) accumulate(m, target(op), p);
    if constexpr (Kind == Mac::LoadNegative) accumulate(m, target(op), -p);
    if constexpr (Kind == Mac::Clear) {
        m.st.acc[a] = 0;
        m.st.sr = static_cast<std::uint16_t>(m.st.sr & ~(a ? sr::OB | sr::SB : sr::OA | sr::SA));
        summarise(m);
    }
    if constexpr (Kind == Mac::Distance || Kind == Mac::AddDistance)
        set_w(m, x_register(op), static_cast<std::uint32_t>(fetched.x - fetched.y));
    else
        put_prefetched(m, op, fetched);
    if constexpr (WriteBack) store_other(m, op, other);
    return op + 1;
}

void use_pointer(Op& op, int reg) {
    op.uses |= 0x10001u << reg;
}

void bind_mac(Op& op, const Form& form, std::uint32_t word, Handler handler) {
    const auto f = [&](char letter) { return form.field(letter, word); };
    if (form.pattern.substr(0, 6) == "111100") {
        op.b = op.s = static_cast<std::uint8_t>(4 + f('m'));
    } else {
        static constexpr std::uint8_t kPairs[8][2] = {{4, 5}, {4, 6}, {4, 7}, {4, 4},
                                                      {5, 6}, {5, 7}, {6, 7}, {4, 4}};
        op.b = kPairs[f('m')][0];
        op.s = kPairs[f('m')][1];
    }
    op.aux = static_cast<std::uint8_t>(f('A'));
    const std::uint32_t i = f('i');
    const std::uint32_t j = f('j');
    const std::uint32_t aa = form.has_field('a') ? f('a') : 2;
    op.k = static_cast<std::uint16_t>(i << 12 | j << 8 | f('x') << 6 | f('y') << 4 | aa << 2);
    if (i != kNoPrefetch) {
        use_pointer(op, i < 8 ? 8 : 9);
        sets(op, x_register(&op));
    }
    if (j != kNoPrefetch) {
        use_pointer(op, j < 8 ? 10 : 11);
        if (form.has_field('y')) sets(op, y_register(&op));
    }
    if (i == kRegisterOffset || j == kRegisterOffset) use_pointer(op, 12);
    if (aa == 0) sets(op, 13);
    if (aa == 1) {
        op.uses |= 0x10000u << 13;
        op.writes |= 1u << 13;
    }
    op.base = handler;
}

std::int16_t signed4(std::uint32_t field) {
    return static_cast<std::int16_t>(field & 8 ? static_cast<int>(field) - 16 : static_cast<int>(field));
}
template <bool Add>
Handler pick_from(Ea from) {
    if (from == Ea::Direct) return &from_word<Add, Ea::Direct>;
    if (from == Ea::Indirect) return &from_word<Add, Ea::Indirect>;
    return &from_word<Add, Ea::Offset>;
}
template <bool Round>
Handler pick_to(Ea to) {
    if (to == Ea::Direct) return &to_word<Round, Ea::Direct>;
    if (to == Ea::Indirect) return &to_word<Round, Ea::Indirect>;
    return &to_word<Round, Ea::Offset>;
}

}  // namespace

bool bind_dsp(Op& op, const Form& form, std::uint32_t word) {
    if (form.has_field('A')) op.aux = static_cast<std::uint8_t>(form.field('A', word));
    switch (form.id) {
    case FormId::ADD_Acc:
        op.base = &add_accumulators;
        return true;
    case FormId::SUB_Acc:
        op.base = &subtract_accumulators;
        return true;
    case FormId::NEG_Acc:
        op.base = &negate_accumulator;
        return true;
    case FormId::ADD_Ws_Acc:
    case FormId::LAC_Ws_Acc: {
        op.b = static_cast<std::uint8_t>(form.field('w', word));
        op.k = static_cast<std::uint16_t>(signed4(form.field('r', word)));
        const Ea from = bind_source(op, form, word, 'g', 2);
        op.base = form.id == FormId::ADD_Ws_Acc ? pick_from<true>(from) : pick_from<false>(from);
        return true;
    }
    case FormId::SAC_Acc_Wd:
    case FormId::SAC_R_Acc_Wd: {
        op.b = static_cast<std::uint8_t>(form.field('w', word));
        op.k = static_cast<std::uint16_t>(signed4(form.field('r', word)));
        const Ea to = bind_destination(op, form, word, 'h', 2);
        op.base = form.id == FormId::SAC_R_Acc_Wd ? pick_to<true>(to) : pick_to<false>(to);
        return true;
    }
    case FormId::SFTAC_Acc_Slit6: {
        const int k = static_cast<int>(form.field('k', word));
        op.k = static_cast<std::uint16_t>(k & 0x20 ? k - 0x40 : k);
        op.base = &shift_accumulator<false>;
        return true;
    }
    case FormId::SFTAC_Acc_Wn:
        op.s = static_cast<std::uint8_t>(form.field('s', word));
        op.base = &shift_accumulator<true>;
        return true;
    case FormId::MAC_WmxWn_Acc_awb:
        bind_mac(op, form, word, &mac<Mac::Add, true>);
        return true;
    case FormId::MSC_WmxWn_Acc_awb:
        bind_mac(op, form, word, &mac<Mac::Subtract, true>);
        return true;
    case FormId::MPY_WmxWn_Acc:
    case FormId::MPY_WmxWm_Acc:
        bind_mac(op, form, word, &mac<Mac::Load, false>);
        return true;
    case FormId::MPY_N_WmxWn_Acc:
        bind_mac(op, form, word, &mac<Mac::LoadNegative, false>);
        return true;
    case FormId::MAC_WmxWm_Acc:
        bind_mac(op, form, word, &mac<Mac::Add, false>);
        return true;
    case FormId::CLR_Acc_awb:
        bind_mac(op, form, word, &mac<Mac::Clear, true>);
        return true;
    case FormId::MOVSAC_Acc_awb:
        bind_mac(op, form, word, &mac<Mac::MoveOnly, true>);
        return true;
    case FormId::ED_WmxWm_Acc_X_Y_Wxd:
        bind_mac(op, form, word, &mac<Mac::Distance, false>);
        return true;
    case FormId::EDAC_WmxWm_Acc_X_Y_Wxd:
        bind_mac(op, form, word, &mac<Mac::AddDistance, false>);
        return true;
    default:
        return false;
    }
}

}  // namespace puckloop::dspic
