// When interrupts and traps may be taken.

#include "emu/dspic/machine/machine.h"

namespace puckloop::dspic {

void reconsider(Machine& m, Cycle now) {
    const int level = m.irq.first().level;
    bool may = level > cpu_level(m);
    m.disi_waits = false;
    if (may && level < 7 && now < m.st.disi_end) {
        may = false;
        m.disi_waits = true;
        m.limit = 0;
    }
    if (may && !m.eligible) m.since = now;
    if (may) m.limit = 0;
    m.eligible = may;
}

void raise_trap(Machine& m, Trap trap) {
    // A hard trap under a higher one cannot be held: the part resets.
    const int level = trap_level(trap);
    constexpr int kLowestHard = trap_level(Trap::AddressError);
    const bool higher_waits = m.irq.first().level > level;
    if (level >= kLowestHard && (cpu_level(m) > level || higher_waits))
        return request_reset(m, ResetCause::TrapConflict);
    m.irq.raise_trap(trap, m.st.cycle);
}

}  // namespace puckloop::dspic
