// Resets, performed between instructions.

#include "emu/avr/machine/machine.h"

namespace puckloop::avr {

std::string_view to_string(ResetCause cause) {
    switch (cause) {
    case ResetCause::PowerOn:
        return "power-on";
    case ResetCause::External:
        return "external";
    case ResetCause::BrownOut:
        return "brown-out";
    case ResetCause::Watchdog:
        return "watchdog";
    }
    return "?";
}

void perform_reset(Machine& m, ResetCause cause) {
    m.reset_request.reset();
    m.anew = true;
    m.now = m.cycle;
    if (m.observer.on_reset) m.observer.on_reset(cause, m.pc_of(m.current), m.cycle);
    m.stall_end = 0;  // the hook may halt it anew
    if (m.instrument) m.instrument->reset(m.cycle);
    if (m.hooks.reset) m.hooks.reset(cause);
    m.irq.reset();
    m.sreg = 0;
    m.rampz = 0;
    m.sp = static_cast<std::uint16_t>(m.device.ram_end() - 1);
    m.asleep = m.stopped = m.started = false;
    m.last_vector = -1;
    m.hold_at = kNoCycle;
    m.limit = 0;
    m.pass_pc.reset();
    m.current = m.code + (m.hooks.reset_pc ? m.hooks.reset_pc() : 0);
}

}  // namespace puckloop::avr
