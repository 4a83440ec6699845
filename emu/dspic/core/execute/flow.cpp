// Program flow: branches, calls, returns, hardware loops, and the instructions that control the processor.
// Cycles: a branch not taken 1, taken 2; returns 3, or 2 when an exception is waiting to be taken.

#include "emu/dspic/core/machine.h"

namespace puckloop::dspic {

namespace {

enum class If { Always, OV, C, Z, N, LE, LT, LEU, NOV, NC, NZ, NN, GT, GE, GTU, OA, OB, SA, SB };

template <If Condition>
bool holds(std::uint32_t s) {
    const bool c = s & sr::C;
    const bool z = s & sr::Z;
    const bool less = ((s >> 3 ^ s >> 2) & 1) != 0;  // N xor OV
    switch (Condition) {
    case If::Always:
        return true;
    case If::OV:
        return s & sr::OV;
    case If::C:
        return c;
    case If::Z:
        return z;
    case If::N:
        return s & sr::N;
    case If::LE:
        return z || less;
    case If::LT:
        return less;
    case If::LEU:
        return !c || z;
    case If::NOV:
        return !(s & sr::OV);
    case If::NC:
        return !c;
    case If::NZ:
        return !z;
    case If::NN:
        return !(s & sr::N);
    case If::GT:
        return !z && !less;
    case If::GE:
        return !less;
    case If::GTU:
        return c && !z;
    case If::OA:
        return s & sr::OA;
    case If::OB:
        return s & sr::OB;
    case If::SA:
        return s & sr::SA;
    case If::SB:
        return s & sr::SB;
    }
}

template <If Condition>
const Op* branch(Machine& m, const Op* op) {
    if (!holds<Condition>(m.st.sr)) return op + 1;
    if constexpr (Condition != If::Always) ++m.st.cycle;
    return at(m, op->target);
}
/// A short backward branch closes a loop that may be a busy wait.
template <If Condition>
const Op* branch_back(Machine& m, const Op* op) {
    if (!holds<Condition>(m.st.sr)) return op + 1;
    if constexpr (Condition != If::Always) ++m.st.cycle;
    const Op* next = at(m, op->target);
    if (op->may_skip) try_skip(m, op, next);
    return next;
}
template <If Condition>
void bind_branch(Op& op, const Form& form, std::uint32_t word, std::uint32_t pc) {
    const int offset = static_cast<std::int16_t>(form.field('n', word));
    op.target = static_cast<std::uint32_t>(static_cast<int>(pc) + 2 + 2 * offset) & kProgramSpace;
    constexpr int kFarthest = -64;
    op.may_skip = offset < 0 && offset >= kFarthest;
    op.base = op.may_skip ? &branch_back<Condition> : &branch<Condition>;
    op.aux = static_cast<std::uint8_t>(Condition);
}

void push_return(Machine& m, std::uint32_t address) {
    push(m, static_cast<std::uint16_t>(address));
    push(m, static_cast<std::uint16_t>(address >> 16));
}
std::uint32_t pop_return(Machine& m) {
    const std::uint16_t high = pop(m);
    return stacked_pc(pop(m), high);
}

const Op* branch_w(Machine& m, const Op* op) {
    const int offset = static_cast<std::int16_t>(m.st.w[op->s]);
    return at(m, static_cast<std::uint32_t>(static_cast<int>(op->target) + 2 * offset) & kProgramSpace);
}
const Op* goto_w(Machine& m, const Op* op) {
    return at(m, m.st.w[op->s] & 0xFFFEu);
}
/// CALL (two words) and RCALL; k = bytes of the instruction in program-counter units.
const Op* call(Machine& m, const Op* op) {
    push_return(m, m.pc_of(op) + op->k);
    return at(m, op->target);
}
const Op* call_w(Machine& m, const Op* op) {
    const std::uint32_t target = m.st.w[op->s] & 0xFFFEu;
    push_return(m, m.pc_of(op) + 2);
    return at(m, target);
}
const Op* rcall_w(Machine& m, const Op* op) {
    const int offset = static_cast<std::int16_t>(m.st.w[op->s]);
    push_return(m, op->target);
    return at(m, static_cast<std::uint32_t>(static_cast<int>(op->target) + 2 * offset) & kProgramSpace);
}
const Op* return_to(Machine& m, std::uint32_t address) {
    if (m.eligible) --m.st.cycle;
    return at(m, address);
}
const Op* return_plain(Machine& m, const Op*) {
    return return_to(m, pop_return(m));
}
template <bool Byte>
const Op* return_literal(Machine& m, const Op* op) {
    const std::uint32_t address = pop_return(m);
    put_w<Byte>(m, op->d, op->k);
    return return_to(m, address);
}
/// Pops {SR<7:0>, IPL3, PC<22:16>} and PC<15:0>. If a next exception may now be taken, two cycles.
const Op* return_from_interrupt(Machine& m, const Op*) {
    const std::uint16_t high = pop(m);
    const std::uint16_t low = pop(m);
    m.st.sr = static_cast<std::uint16_t>((m.st.sr & 0xFF00) | high >> 8);
    m.st.corcon =
        static_cast<std::uint16_t>((m.st.corcon & ~corcon::IPL3) | (high & kStackedIpl3 ? corcon::IPL3 : 0));
    m.eligible = false;
    reconsider(m, m.st.cycle + 1);
    m.repeat_first = true;  // RA may have come back
    m.limit = 0;
    return return_to(m, stacked_pc(low, high));
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

const Op* nop(Machine&, const Op* op) {
    return op + 1;
}
/// Priorities 1 to 6 are held for count + 1 cycles, this one included.
const Op* disable_interrupts(Machine& m, const Op* op) {
    m.st.disi_end = m.st.cycle + 1 + op->k;
    reconsider(m, m.st.cycle);
    return op + 1;
}
const Op* power_save(Machine& m, const Op* op) {
    enter_power_save(m, op->k ? PowerMode::Idle : PowerMode::Sleep);
    return op + 1;
}
const Op* clear_wdt(Machine& m, const Op* op) {
    clear_watchdog(m);
    rcon_register(m) &= static_cast<std::uint16_t>(~(rcon::SLEEP | rcon::IDLE));
    return op + 1;
}
const Op* software_reset(Machine& m, const Op* op) {
    request_reset(m, ResetCause::Software);
    return op + 1;
}

}  // namespace

bool bind_flow(Op& op, const Form& form, std::uint32_t word, std::uint32_t word2, std::uint32_t pc) {
    const auto relative = [&](std::uint32_t field, std::uint32_t from) {
        const int offset = static_cast<std::int16_t>(field);
        return static_cast<std::uint32_t>(static_cast<int>(from) + 2 * offset) & kProgramSpace;
    };
    const auto far_target = [&] { return form.field2('n', word2) << 16 | form.field('n', word) << 1; };
    if (form.has_field('s')) op.s = static_cast<std::uint8_t>(form.field('s', word));
    if (form.has_field('k')) op.k = static_cast<std::uint16_t>(form.field('k', word));
    switch (form.id) {
        // clang-format off
#define BRANCH(NAME) case FormId::BRA_##NAME##_Expr: bind_branch<If::NAME>(op, form, word, pc); return true;
    BRANCH(OV) BRANCH(C) BRANCH(Z) BRANCH(N) BRANCH(LE) BRANCH(LT) BRANCH(LEU) BRANCH(NOV) BRANCH(NC)
    BRANCH(NZ) BRANCH(NN) BRANCH(GT) BRANCH(GE) BRANCH(GTU) BRANCH(OA) BRANCH(OB) BRANCH(SA) BRANCH(SB)
#undef BRANCH
            // clang-format on
            case FormId::BRA_Expr : bind_branch<If::Always>(op, form, word, pc);
        return true;
    case FormId::GOTO_Expr:
        op.target = far_target();
        op.may_skip = op.target <= pc && pc - op.target <= 128;
        op.base = op.may_skip ? &branch_back<If::Always> : &branch<If::Always>;
        return true;
    case FormId::BRA_Wn:
        op.target = pc + 2;
        op.base = &branch_w;
        return true;
    case FormId::GOTO_Wn:
        op.base = &goto_w;
        return true;
    case FormId::CALL_Expr:
        op.target = far_target();
        op.k = 4;
        op.base = &call;
        return true;
    case FormId::RCALL_Expr:
        op.target = relative(form.field('n', word), pc + 2);
        op.k = 2;
        op.base = &call;
        return true;
    case FormId::CALL_Wn:
        op.base = &call_w;
        return true;
    case FormId::RCALL_Wn:
        op.target = pc + 2;
        op.base = &rcall_w;
        return true;
    case FormId::RETURN:
        op.uses |= 1u << 15;
        op.base = &return_plain;
        return true;
    case FormId::RETLW_lit10_Wn:
        op.uses |= 1u << 15;
        op.d = static_cast<std::uint8_t>(form.field('d', word));
        initialises(op, op.d);
        op.base = form.field('B', word) ? &return_literal<true> : &return_literal<false>;
        return true;
    case FormId::RETFIE:
        op.uses |= 1u << 15;
        op.base = &return_from_interrupt;
        return true;
    case FormId::DO_lit14_Expr:
    case FormId::DO_Wn_Expr:
        op.target = relative(form.field2('n', word2), pc + 4);
        op.base = form.id == FormId::DO_lit14_Expr ? &do_literal : &do_w;
        return true;
    case FormId::REPEAT_lit14:
        op.base = &repeat_literal;
        return true;
    case FormId::REPEAT_Wn:
        op.base = &repeat_w;
        return true;
    case FormId::NOP:
    case FormId::NOPR:
        op.base = &nop;
        return true;
    case FormId::DISI_lit14:
        op.base = &disable_interrupts;
        return true;
    case FormId::PWRSAV_lit1:
        op.base = &power_save;
        return true;
    case FormId::CLRWDT:
        op.base = &clear_wdt;
        return true;
    case FormId::RESET:
        op.base = &software_reset;
        return true;
    default:
        return false;
    }
}

}  // namespace puckloop::dspic
