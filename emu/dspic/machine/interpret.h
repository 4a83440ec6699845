#pragma once
// The interpreter's inner loop: instructions one after the other. It is the reference for translated code,
// and executes what that leaves to it.

#include "emu/dspic/machine/machine.h"

#include <utility>

namespace puckloop::dspic {

/// A pointer was just written (one cycle of stall) or never written (reset). The instruction has not started.
[[gnu::noinline]] inline const Op* execute_with_hazard(Machine& m, const Op* op) {
    if (op->uses & m.watch & 0xFFFF0000) {
        request_reset(m, ResetCause::IllegalOpcode);
        return op;
    }
    m.watch = (m.watch & op->keep) | op->writes;
    const Op* next = op->run(m, op);
    m.st.cycle += op->cycles + 1u;
    ++m.instructions;
    return next;
}

/// The instruction at Machine::current, which is `op`. Returns the next one.
[[gnu::always_inline]] inline const Op* execute_one(Machine& m, const Op* op) {
    if (op->uses & m.watch) [[unlikely]]
        return execute_with_hazard(m, op);
    m.watch = (m.watch & op->keep) | op->writes;
    const Op* next = op->run(m, op);
    m.st.cycle += op->cycles;
    ++m.instructions;
    return next;
}

/// Executes while the cycle is below Machine::limit; RA is not set.
inline void run_interpreted(Machine& m) {
    const Op* op = m.current;
    do {
        m.current = op;
        if (m.stops_at(op)) break;
        op = execute_one(m, op);
    } while (m.st.cycle < m.limit);
    m.current = op;
    m.st.cycle += std::exchange(m.late, 0);
}

}  // namespace puckloop::dspic
