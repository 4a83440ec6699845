// Instructions, repeated instructions, interrupt entry, stops, and waiting.
//
// Everything that has to interrupt the flow (an event, the end of the grant, an interrupt, a stop) is folded
// into Machine::limit; the inner loop compares the cycle with it and nothing else.

#include "emu/dspic/core/run.h"

#include "emu/dspic/fast/idle_loops.h"
#include "emu/dspic/fast/known_services.h"
#include "emu/dspic/fast/loop_advance.h"
#include "emu/dspic/machine/interpret.h"
#include "emu/dspic/machine/machine.h"
#include "emu/dspic/translate/translation.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace puckloop::dspic {

namespace {

/// RA is set: the instruction at PC runs RCOUNT + 1 times.
void run_repeated(Machine& m) {
    const Op* op = m.current;
    if (op->run == &decode_now) decode(m, m.code[op - m.code]);
    if (op->base != op->run && op->marks & kStop) {
        op->run(m, op);
        ++m.instructions;
        return;
    }
    if (m.limit > m.gate.from) m.limit = std::max(m.gate.from, m.st.cycle + 1);
    if (op->form == FormId::NOP || op->form == FormId::NOPR) {
        const Cycle skipped = std::min<Cycle>(m.st.rcount, m.limit - m.st.cycle);
        m.st.rcount = static_cast<std::uint16_t>(m.st.rcount - skipped);
        m.st.cycle += skipped;
        m.instructions += skipped;
        if (m.st.cycle >= m.limit) return;
    }
    do {
        const bool last = m.st.rcount == 0;
        m.repeat_edge = m.repeat_first || last || m.eligible;
        m.repeat_first = false;
        const bool stall = op->uses & m.watch;
        if (op->uses & m.watch & 0xFFFF0000) return request_reset(m, ResetCause::IllegalOpcode);
        m.watch = (m.watch & op->keep) | op->writes;
        const Op* next = op->run(m, op);
        m.st.cycle += op->cycles + std::exchange(m.late, 0) + (stall ? 1 : 0);
        ++m.instructions;
        if (last) {
            m.st.sr &= static_cast<std::uint16_t>(~sr::RA);
            m.current = next;
            return;
        }
        --m.st.rcount;
    } while (m.st.cycle < m.limit);
}

/// The interpreter with an instrument looking on.
void execute_observed(Machine& m) {
    const auto looks = [&m] {
        if (m.current->marks & kStop && m.current->run != m.current->base) return true;  // ends the run first
        m.anew = false;
        // A debugger may have pressed reset: then another instruction is next, and is shown first.
        if (m.instrument->instruction(m.pc_of(m.current), m.st.cycle)) return !m.anew;
        m.stopped = true;
        m.limit = 0;
        return false;
    };
    if (m.st.sr & sr::RA) {
        if (!looks()) return;
        m.limit = std::min(m.limit, m.st.cycle + 1);
        return run_repeated(m);
    }
    do {
        if (m.current->run == &decode_now) decode(m, m.code[m.current - m.code]);
        if (!looks()) return;
        m.current = execute_one(m, m.current);
    } while (m.st.cycle < m.limit && !m.stops_at(m.current));
    m.st.cycle += std::exchange(m.late, 0);
}

void execute(Machine& m) {
    if (m.instrument)
        execute_observed(m);
    else if (m.st.sr & sr::RA)
        run_repeated(m);
    else if (m.doze.on)
        run_interpreted(m);
    else if (m.skip->position.op == m.current && advance_in_loop(m))
        return;
    else if (m.translated.on)
        run_translated(m);
    else
        run_interpreted(m);
}

/// CPU level of the routine of this interrupt or trap.
int service_level(const Machine& m, const InterruptController::Request& taken) {
    if (taken.level > 7) return taken.level & 7;
    return m.irq.nesting_disabled() ? 7 : taken.level;
}

void set_level(Machine& m, int level) {
    m.st.sr = static_cast<std::uint16_t>((m.st.sr & ~sr::IPL) | level << sr::kIplShift);
}

void enter_interrupt(Machine& m) {
    const InterruptController::Request taken = m.irq.first();
    const bool trap = taken.level > 7;
    const std::uint32_t pc = m.pc_of(m.current);
    if (trap && m.observer.on_trap) m.observer.on_trap(static_cast<Trap>(taken.vector), pc, m.st.cycle);
    if (!trap && m.observer.on_interrupt) m.observer.on_interrupt(taken.vector, pc, m.st.cycle);
    if (m.instrument) m.instrument->interrupt(taken.vector, pc, m.st.cycle);
    m.irq.acknowledge(taken, cpu_level(m));

    push(m, stacked_pc_low(pc));
    push(m, stacked_status(m.st.sr, m.st.corcon, pc));

    set_level(m, service_level(m, taken));
    m.st.sr &= static_cast<std::uint16_t>(~sr::RA);
    if (trap) m.st.corcon |= corcon::IPL3;
    m.watch &= 0xFFFF0000;

    const std::uint32_t table = m.irq.alternate_table() ? m.device.aivt : m.device.ivt;
    const std::uint32_t handler = m.program[table / 2 + static_cast<std::uint32_t>(taken.vector)];
    const Cycle start =
        m.doze.on ? service_start(m.since, m.st.cycle, m.doze.ratio) : service_start(m.since, m.st.cycle);
    m.eligible = false;
    reconsider(m, m.st.cycle);
    m.st.cycle = start;
    m.current = at(m, handler & kProgramSpace);
}

/// A service routine is passed in one step: all but its last instruction. `Known`: IsrSummary or IsrPath.
template <class Known>
void leave_service(Machine& m, const Known& routine) {
    m.irq.serve_alone();
    m.eligible = m.disi_waits = false;
    m.watch = (m.watch & routine.keep) | routine.writes;
    m.repeat_first = true;
    m.instructions += routine.instructions;
    m.skip->work.service_instructions += routine.instructions;
    ++m.skip->work.services;
}

bool pass_summary(Machine& m, const IsrSummary& summary, Cycle start, Cycle horizon) {
    const Cycle end = start + summary.cycles;
    if (end > horizon || summary.uses & m.watch & 0xFFFF0000 || !stack_holds(m, summary.depth, m.st.w[15]) ||
        !refreshes_hold(m, summary) || !m.irq.waits_alone())
        return false;
    m.irq.acknowledge(m.irq.first(), cpu_level(m));
    push_trace(m, summary, {m.st.w.data(), m.st.sr, m.pc_of(m.current)});
    leave_service(m, summary);
    m.st.cycle = end;
    return true;
}

/// Until `end` one event at most falls due, and all it does is to set a flag that cannot interrupt the
/// routine of `taken`.
bool only_flags_until(const Machine& m, Cycle end, const InterruptController::Request& taken) {
    const EventQueue::Slot slot = m.events.next_slot();
    const EventQueue::Steady& steady = m.events.steady(slot);
    return end <= m.until && steady.irq >= 0 && steady.irq != taken.vector - kTrapVectors &&
           !m.irq.gated(steady.irq) && !m.irq.tapped(steady.irq) &&
           m.irq.priority(steady.irq) <= service_level(m, taken) && end <= m.events.next() + steady.period &&
           end <= m.events.next_except(slot);
}

bool pass_path(Machine& m, const IsrPath& path, const Service& service, Cycle horizon) {
    const InterruptController::Request taken = m.irq.first();
    Cycle end = service.start + path.cycles;
    if (!m.irq.waits_alone() || (end > horizon && !only_flags_until(m, end, taken))) return false;
    m.irq.acknowledge(taken, cpu_level(m));
    take_path(m, path, service);
    leave_service(m, path);
    m.st.cycle = service.start + path.returns;
    if (m.events.next() <= m.st.cycle) {
        const std::uint16_t status = m.st.sr;
        set_level(m, service.level);
        m.events.service(m.st.cycle);
        m.st.sr = status;
        reconsider(m, m.st.cycle + 1);  // as RETFIE does
        if (m.eligible) --end;
    }
    m.st.cycle = end;
    return true;
}

/// The interrupt first in line, its routine included, in one step, if that is exact.
bool pass_service(Machine& m, Cycle horizon) {
    if (!m.skip_idle || m.doze.on || m.st.sr & sr::RA || m.st.disi_end > m.st.cycle ||
        m.observer.on_interrupt)
        return false;
    const int vector = m.irq.first().vector;
    const Cycle start = service_start(m.since, m.st.cycle);
    if (!has_paths(m, vector)) {
        if (const IsrSummary* summary = isr_summary(m, vector))
            return pass_summary(m, *summary, start, horizon);
        // A program that does not wait in loops gains less by paths than learning them costs.
        if (m.skip->position.table == nullptr) return false;
    }
    const Service service{start, service_level(m, m.irq.first())};
    const IsrPath* path = isr_path(m, vector, service);
    return path && pass_path(m, *path, service, horizon);
}

/// Executes the instruction under a stop address that was reported before.
void pass_stop(Machine& m) {
    const std::uint32_t pc = *m.pass_pc;
    m.pass_pc.reset();
    if (pc >> 1 >= m.code_words || !(m.code[pc >> 1].marks & kStop)) return execute(m);  // by an instrument
    Op& op = m.code[pc >> 1];
    if (m.program_undo.on()) m.program_undo.note_operation(m, pc >> 1);
    op.marks &= static_cast<std::uint8_t>(~kStop);
    forget_loops(m);
    decode(m, op);
    m.limit = std::min(m.limit, m.st.cycle + 1);
    if (m.instrument)
        execute_observed(m);
    else
        m.st.sr& sr::RA ? run_repeated(m) : run_interpreted(m);
    op.marks |= kStop;
    forget_loops(m);
    decode(m, op);
}

/// One instruction of a slow CPU, or the one that makes it slow.
void execute_dozing(Machine& m) {
    const Cycle began = m.st.cycle;
    m.limit = std::min(m.limit, began + 1);
    if (m.pass_pc && *m.pass_pc == m.pc_of(m.current))
        pass_stop(m);
    else
        execute(m);
    stretch(m, began);
}

/// Idle or Sleep is over: the CPU's clock starts, and what ended it is taken without another instruction.
void wake(Machine& m) {
    leave_power_save(m);
    if (!m.doze.on) {
        if (m.eligible && m.since >= m.st.cycle) m.since = m.st.cycle == 0 ? 0 : m.st.cycle - 1;
        return;
    }
    if (m.eligible) recover(m);
    m.st.cycle += m.doze.ratio - 1;
    if (m.eligible) m.since = std::min(m.since, m.st.cycle - m.doze.ratio);
}

/// What ends Sleep has come: the clock needs its time first.
bool starts_oscillator(Machine& m) {
    if (m.mode != PowerMode::Sleep) return false;
    if (m.wake_end == kNoCycle)
        m.wake_end = m.st.cycle + static_cast<Cycle>(std::llround(m.wake_seconds * m.cycle_rate));
    return m.wake_end > m.st.cycle;
}

/// The run ends here, before the operation that is next. What looks at the gate itself, before each
/// operation, is asked here only where an event is due in this very cycle: that comes after whatever arrives
/// in it.
bool waits_at_gate(Machine& m) {
    if (m.st.cycle < m.gate.from || m.gate.held) return m.gate.held;
    const bool looks_itself = !m.instrument && !m.doze.on && !m.pass_pc && !(m.st.sr & sr::RA);
    m.gate.held =
        m.reset_request || ((m.events.next() <= m.st.cycle || !looks_itself) && may_access(m, m.current));
    return m.gate.held;
}

}  // namespace

Core::Outcome run_until(Machine& m, Cycle until) {
    m.end_requested = false;
    m.until = until;
    m.gate.held = false;
    while (true) {
        if (waits_at_gate(m)) {
            m.until = until = std::min(until, m.st.cycle);
            if (m.reset_request) return Core::Outcome::Until;
        } else if (m.reset_request) {
            perform_reset(m, *m.reset_request);
        }
        const Cycle horizon = std::min(m.st.cycle, until == 0 ? 0 : until - 1);
        if (m.events.next() <= horizon && until != 0) {
            m.events.service(horizon);
            if (m.reset_request) continue;
        }
        if (m.end_requested || m.st.cycle >= until) return Core::Outcome::Until;
        if (m.doze.remaining_cycles > 0) [[unlikely]] {
            consume_cycle(m);
            continue;
        }
        const Cycle quiet = std::min(until, m.events.next());
        if (m.mode != PowerMode::Run) {
            if (!m.irq.any_enabled_flag()) {
                m.st.cycle = std::min(until, m.events.next());
                continue;
            }
            if (starts_oscillator(m)) {
                m.st.cycle = std::min(quiet, m.wake_end);
                continue;
            }
            wake(m);
            if (m.doze.on) continue;
        }
        if (m.held || m.stall_end > m.st.cycle) {
            m.st.cycle = m.held ? quiet : std::min(quiet, m.stall_end);
            continue;
        }
        if (m.disi_waits && m.st.cycle >= m.st.disi_end) reconsider(m, m.st.disi_end);
        if (m.eligible && m.since + m.doze.ratio <= m.st.cycle) {
            if (!pass_service(m, quiet)) enter_interrupt(m);
            continue;
        }
        m.limit = quiet;
        if (m.eligible)
            m.limit = m.st.cycle + 1;
        else if (m.disi_waits)
            m.limit = std::min(m.limit, m.st.disi_end);
        if (m.doze.on) {
            execute_dozing(m);
        } else {
            if (m.pass_pc && *m.pass_pc == m.pc_of(m.current)) {
                pass_stop(m);
                if (m.doze.on) stretch(m, m.doze.entry);
                continue;
            }
            execute(m);
            if (m.doze.on) [[unlikely]]
                stretch(m, m.doze.entry);
        }
        if (m.stopped) {
            m.stopped = false;
            m.pass_pc = m.pc_of(m.current);
            return Core::Outcome::Stopped;
        }
    }
}

}  // namespace puckloop::dspic
