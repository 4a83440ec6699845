// What of the program flow is written for the interpreter alone: returns from interrupts, hardware loops, and
// the instructions that control the processor. Cycles: returns 3, or 2 when an exception is waiting to be
// taken: its handler begins four cycles later, which is five behind the cycle that lowers the level.

#include "emu/dspic/machine/execute/branches.h"

namespace puckloop::dspic {

namespace {

/// Pops {SR<7:0>, IPL3, PC<22:16>} and PC<15:0>. The level is restored in the second cycle.
const Op* return_from_interrupt(Machine& m, const Op*) {
    const std::uint16_t high = pop(m);
    const std::uint16_t low = pop(m);
    m.st.sr = static_cast<std::uint16_t>((m.st.sr & 0xFF00) | high >> 8);
    m.st.corcon =
        static_cast<std::uint16_t>((m.st.corcon & ~corcon::IPL3) | (high & kStackedIpl3 ? corcon::IPL3 : 0));
    m.eligible = false;
    reconsider(m, m.st.cycle + 1);
    m.repeat_first = true;
    if (m.st.sr & sr::RA) m.limit = 0;
    return Words(m).return_to(stacked_pc(low, high));
}

constexpr std::uint16_t kCountMask = 0x3FFF;

const Op* start_loop(Machine& m, const Op* op, std::uint16_t count) {
    CoreState& st = m.st;
    st.loop_shadow = st.loop;
    st.loop = {static_cast<std::uint16_t>(count & kCountMask), m.pc_of(op) + 4, op->target};
    const int level = (st.corcon & corcon::DL) >> corcon::kDlShift;
    if (level < 7) st.corcon = static_cast<std::uint16_t>(st.corcon + (1 << corcon::kDlShift));
    st.sr |= sr::DA;
    mark(m, op->target, kLoopEnd);
    return op + 2;
}
const Op* do_literal(Machine& m, const Op* op) {
    return start_loop(m, op, op->k);
}
const Op* do_w(Machine& m, const Op* op) {
    return start_loop(m, op, m.st.w[op->s]);
}

/// With a count above 0 the next instruction repeats; the run loop does it when it sees RA.
const Op* start_repeat(Machine& m, const Op* op, std::uint16_t count) {
    m.st.rcount = count & kCountMask;
    if (m.st.rcount != 0) {
        m.st.sr |= sr::RA;
        m.repeat_first = true;
        m.limit = 0;
    }
    return op + 1;
}
const Op* repeat_literal(Machine& m, const Op* op) {
    return start_repeat(m, op, op->k);
}
const Op* repeat_w(Machine& m, const Op* op) {
    return start_repeat(m, op, m.st.w[op->s]);
}

/// Priorities 1 to 6 are held for count + 1 cycles, this one included.
const Op* disable_interrupts(Machine& m, const Op* op) {
    m.st.disi_end = m.st.cycle + (Cycle{1} + op->k) * m.doze.ratio;
    reconsider(m, m.st.cycle);
    return op + 1;
}
const Op* power_save(Machine& m, const Op* op) {
    enter_power_save(m, op->k ? PowerMode::Idle : PowerMode::Sleep);
    return op + 1;
}
const Op* software_reset(Machine& m, const Op* op) {
    request_reset(m, ResetCause::Software);
    return op + 1;
}

}  // namespace

bool bind_flow(Op& op, const Form& form, std::uint32_t word, std::uint32_t word2, std::uint32_t pc) {
    const bool shared =
        with_branch(form.id, [&](auto semantics) { semantics.bind(op, form, word, word2, pc); });
    if (shared) return true;
    if (form.has_field('s')) op.s = static_cast<std::uint8_t>(form.field('s', word));
    if (form.has_field('k')) op.k = static_cast<std::uint16_t>(form.field('k', word));
    switch (form.id) {
    case FormId::RETFIE:
        op.uses |= 1u << 15;
        op.base = &return_from_interrupt;
        return true;
    case FormId::DO_lit14_Expr:
    case FormId::DO_Wn_Expr:
        op.target = relative_pc(pc + 4, form.field2('n', word2));
        op.base = form.id == FormId::DO_lit14_Expr ? &do_literal : &do_w;
        return true;
    case FormId::REPEAT_lit14:
        op.base = &repeat_literal;
        return true;
    case FormId::REPEAT_Wn:
        op.base = &repeat_w;
        return true;
    case FormId::DISI_lit14:
        op.base = &disable_interrupts;
        return true;
    case FormId::PWRSAV_lit1:
        op.base = &power_save;
        return true;
    case FormId::RESET:
        op.base = &software_reset;
        return true;
    default:
        return false;
    }
}

}  // namespace puckloop::dspic
