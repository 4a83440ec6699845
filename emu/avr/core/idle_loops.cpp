// Idle-loop elision: a short backward branch that comes back to itself with every register unchanged will do
// so until something outside happens.
//
// One turn of the loop is executed for real and watched. If it stays between the branch's target and the
// branch, stores nothing, reads no register whose value follows the clock, and ends with the same registers
// and flags, each further turn is the same turn: nothing in RAM or in a register changes before the next
// event, pin change or end of the grant, all of which bound Machine::limit. As many whole turns as fit before
// that are added to the cycle and instruction counters.

#include "emu/avr/core/execute/handlers.h"

#include <algorithm>
#include <array>

namespace puckloop::avr {

namespace {

constexpr std::size_t kRegisters = 32;
/// A turn is watched only where this many clocks of nothing lie ahead.
constexpr Cycle kWorthwhile = 64;
/// A pin that changed is read late for a clock: a turn is watched only this long after the last event.
constexpr Cycle kSettled = 8;
constexpr std::uint8_t kMostBackoff = 0x7F;

struct Registers {
    std::array<std::uint8_t, kRegisters> r;
    std::uint8_t sreg, rampz;
    std::uint16_t sp;

    explicit Registers(const Machine& m) : sreg(m.sreg), rampz(m.rampz), sp(m.sp) {
        std::copy_n(m.data.begin(), kRegisters, r.begin());
    }
    friend bool operator==(const Registers&, const Registers&) = default;
};

/// Changes nothing but registers and flags, and leads nowhere that the text of the program does not show.
bool is_pure(FormId form) {
    using enum FormId;
    switch (form) {
    case STS:
    case ST_X:
    case ST_X_INC:
    case ST_X_DEC:
    case ST_Y_INC:
    case ST_Y_DEC:
    case STD_Y:
    case ST_Z_INC:
    case ST_Z_DEC:
    case STD_Z:
    case PUSH:
    case POP:
    case OUT:
    case SBI:
    case CBI:
    case CALL:
    case RCALL:
    case ICALL:
    case IJMP:
    case RET:
    case RETI:
    case SPM:
    case SLEEP:
    case WDR:
    case BREAK:
    case BSET:
    case BCLR:
    case Undefined:
        return false;
    default:
        return true;
    }
}

/// Whether the branch at `last`, which leads back to `first`, closes a body of pure instructions.
bool body_is_pure(Machine& m, std::uint32_t first, std::uint32_t last) {
    for (std::uint32_t i = first; i <= last; i += static_cast<std::uint32_t>(length_of(m.program[i])))
        if (!is_pure(find_form_id(m.program[i]))) return false;
    return true;
}

/// Executes one turn from `head` on; null if it left the body, in which case `at` is where it is now.
bool turn(Machine& m, const Op* head, const Op* branch, const Op*& at) {
    at = head;
    while (at != branch) {
        const Op* op = at;
        at = op->run(m, op);
        m.cycle += op->cycles;
        ++m.instructions;
        if (at < head || at > branch || m.cycle >= m.limit) return false;
    }
    return true;
}

}  // namespace

const Op* leap(Machine& m, const Op* branch, const Op* head) {
    LoopInfo& loop = m.loops[m.pc_of(branch)];
    if (loop.purity == LoopInfo::Purity::Unknown)
        loop.purity = body_is_pure(m, m.pc_of(head), m.pc_of(branch)) ? LoopInfo::Purity::Pure
                                                                      : LoopInfo::Purity::Impure;
    if (loop.purity == LoopInfo::Purity::Impure) {  // never asked again
        m.code_store[m.pc_of(branch)].run = loop_handler(branch->form);
        return head;
    }
    const Cycle now = m.cycle + branch->cycles;  // the branch itself is over then
    if (m.limit <= now + kWorthwhile || now < m.quiet_since + kSettled) return head;

    // From here on the branch's own clocks and count are in; the run loop adds them again.
    m.cycle = now;
    ++m.instructions;
    const auto hand_back = [&](const Op* next) {
        m.cycle -= branch->cycles;
        --m.instructions;
        return next;
    };
    const Registers before(m);
    const std::uint64_t count = m.instructions;
    m.unsteady_read = false;
    const Op* at = head;
    if (!turn(m, head, branch, at)) return hand_back(at);
    const Op* next = loop_handler(branch->form)(m, branch);  // adds the clock of a branch taken
    m.cycle += branch->cycles;
    ++m.instructions;
    const bool same = next == head && !m.unsteady_read && Registers(m) == before && m.limit > m.cycle;
    loop.backoff =
        same ? std::uint8_t{0}
             : std::min<std::uint8_t>(static_cast<std::uint8_t>(loop.backoff * 2 + 1), kMostBackoff);
    if (same) {
        const Cycle period = m.cycle - now;
        const Cycle turns = (m.limit - m.cycle) / period;
        m.cycle += turns * period;
        m.instructions += turns * (m.instructions - count);
    }
    return hand_back(next);
}

}  // namespace puckloop::avr
