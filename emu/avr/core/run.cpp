// Instructions, interrupt entry, stops, and waiting.
//
// Everything that has to interrupt the flow (an event, the end of the grant, an interrupt, a stop) is folded
// into Machine::limit; the inner loop compares the cycle with it and nothing else.

#include "emu/avr/core/run.h"

#include "emu/avr/machine/machine.h"
#include "emu/avr/translate/translation.h"

#include <algorithm>
#include <utility>

namespace puckloop::avr {

namespace {

/// Clocks from the end of the instruction in progress to the first one of the vector, and what waking up adds
/// (data sheet, "Interrupt Response Time").
constexpr Cycle kInterruptResponse = 4;
constexpr Cycle kWakeUp = 4;
constexpr std::uint16_t kWordsPerVector = 2;

/// The interpreter with an instrument looking on.
void execute_observed(Machine& m) {
    const auto stops = [&m](std::uint16_t pc) {
        return std::find(m.stops.begin(), m.stops.end(), pc) != m.stops.end();
    };
    do {
        const std::uint16_t pc = m.pc_of(m.current);
        const bool stop = stops(pc);
        m.anew = false;
        if (!stop && !m.instrument->instruction(pc * 2u, m.cycle)) {
            m.stopped = true;
            m.limit = 0;
            return;
        }
        if (m.anew) return;  // a debugger pressed reset: another instruction is next, and is shown first
        const Op* op = m.current;  // a debugger may have changed it
        if (!stop) {
            if (op->run == &decode_now) decode(m, m.code_store[static_cast<std::size_t>(op - m.code)]);
        }
        m.current = op->run(m, op);
        m.cycle += op->cycles;
        ++m.instructions;
    } while (m.cycle < m.limit);
}

void execute(Machine& m) {
    m.quiet_since = m.cycle;
    if (m.instrument) return execute_observed(m);
    if (m.translated.on && run_translated(m)) return;
    const Op* op = m.current;
    do {
        const Op* next = op->run(m, op);
        m.cycle += op->cycles;
        ++m.instructions;
        op = next;
    } while (m.cycle < m.limit);
    m.current = op;
}

/// Executes the instruction under a stop address that was reported before.
void pass_stop(Machine& m, std::uint16_t pc) {
    const auto stops = std::exchange(m.stops, {});
    forget(m, pc);
    m.limit = m.cycle + 1;
    execute(m);
    m.stops = stops;
    forget(m, pc);
}

void enter_interrupt(Machine& m) {
    if (std::exchange(m.asleep, false)) {
        m.cycle += kWakeUp + m.start_up;
        m.now = m.cycle;
        if (m.hooks.wake) m.hooks.wake();
    }
    const int vector = m.irq.first();
    m.last_vector = static_cast<std::int16_t>(vector);
    const std::uint16_t pc = m.pc_of(m.current);
    if (m.observer.on_interrupt) m.observer.on_interrupt(vector, pc, m.cycle);
    if (m.instrument) m.instrument->interrupt(vector, pc * 2u, m.cycle);
    m.now = m.cycle;
    m.irq.acknowledge(vector);
    push_pc(m, m.current, pc);
    m.sreg &= static_cast<std::uint8_t>(~sreg::I);
    m.cycle += kInterruptResponse;
    const std::uint16_t base = m.hooks.vector_base ? m.hooks.vector_base() : std::uint16_t{0};
    m.current = m.code + static_cast<std::uint16_t>(base + kWordsPerVector * vector);
}

}  // namespace

Core::Outcome run_until(Machine& m, Cycle until) {
    m.end_requested = false;
    while (true) {
        if (m.reset_request) perform_reset(m, *m.reset_request);
        if (m.events.next() <= m.cycle && m.events.next() < until) {
            serve_events(m, std::min(m.cycle, until - 1));
            if (m.reset_request) continue;
        }
        if (m.end_requested || m.cycle >= until) return Core::Outcome::Until;
        const Cycle quiet = std::min(until, m.events.next());
        if (m.stall_end > m.cycle) {
            m.cycle = std::min(quiet, m.stall_end);
            continue;
        }
        if (m.may_interrupt() && m.cycle != m.hold_at &&
            !(m.hooks.interrupts_locked && m.hooks.interrupts_locked())) {
            enter_interrupt(m);
            continue;
        }
        if (m.asleep) {
            m.cycle = quiet;
            continue;
        }
        m.limit = m.may_interrupt() ? m.cycle + 1 : quiet;
        if (m.pass_pc && *m.pass_pc == m.pc_of(m.current)) {
            m.pass_pc.reset();
            pass_stop(m, m.pc_of(m.current));
            continue;
        }
        execute(m);
        if (std::exchange(m.stopped, false)) {
            m.pass_pc = m.pc_of(m.current);
            return Core::Outcome::Stopped;
        }
    }
}

}  // namespace puckloop::avr
