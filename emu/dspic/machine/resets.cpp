// Resets: asked for while an instruction or an event is under way, performed between instructions.

#include "emu/dspic/devices/dspic30f6014a_sfr.h"
#include "emu/dspic/machine/machine.h"

namespace puckloop::dspic {

std::string_view to_string(ResetCause cause) {
    switch (cause) {
    case ResetCause::PowerOn:
        return "power-on";
    case ResetCause::BrownOut:
        return "brown-out";
    case ResetCause::Mclr:
        return "MCLR";
    case ResetCause::Software:
        return "RESET instruction";
    case ResetCause::Watchdog:
        return "watchdog";
    case ResetCause::TrapConflict:
        return "trap conflict";
    case ResetCause::IllegalOpcode:
        return "illegal opcode or uninitialised W register";
    }
    return "";
}

void request_reset(Machine& m, ResetCause cause) {
    if (!m.reset_request) {
        m.reset_request = cause;
        m.fault_pc = m.pc_of(m.current);
    }
    m.limit = 0;
}

void perform_reset(Machine& m, ResetCause cause) {
    m.reset_request.reset();
    m.anew = true;
    m.waits.forget();
    if (m.observer.on_reset) m.observer.on_reset(cause, m.fault_pc, m.st.cycle);
    if (m.instrument) m.instrument->reset(m.st.cycle);
    const std::uint16_t old_rcon = rcon_register(m);
    const std::uint16_t old_nvmcon = m.sfr.raw(sfr::NVMCON);
    if (m.reset_hook) m.reset_hook(cause);
    m.irq.reset();
    reset_registers(m);
    reset_nvm(m, cause, old_nvmcon);

    std::uint32_t value = old_rcon & ~std::uint32_t{m.device.family_33f ? rcon::SWDTEN : 0u};
    constexpr std::uint32_t kBrownOutClears33F =  // DS70286, RCON; the 30F's wait for a power-on reset
        rcon::TRAPR | rcon::IOPUWR | rcon::SWR | rcon::WDTO | rcon::SLEEP | rcon::IDLE;
    switch (cause) {
    case ResetCause::PowerOn:
        value = rcon::POR | rcon::BOR;
        if (!m.device.family_33f) value |= 0x0500;  // LVDL = 0101
        break;
    case ResetCause::BrownOut:
        if (m.device.family_33f) value &= ~kBrownOutClears33F;
        value |= rcon::BOR;
        break;
    case ResetCause::Mclr:
        value |= rcon::EXTR;
        break;
    case ResetCause::Software:
        value |= rcon::SWR;
        break;
    case ResetCause::Watchdog:
        value |= rcon::WDTO;
        break;
    case ResetCause::TrapConflict:
        value |= rcon::TRAPR;
        break;
    case ResetCause::IllegalOpcode:
        value |= rcon::IOPUWR;
        break;
    }
    rcon_register(m) = static_cast<std::uint16_t>(value);
    if (m.rcon_hook) m.rcon_hook();
    if (m.mode != PowerMode::Run) leave_power_save(m);
    clear_watchdog(m);
    m.eligible = m.disi_waits = m.stopped = false;
    m.late = 0;
    m.doze.remaining_cycles = 0;
    m.stall_end = 0;
    m.limit = 0;
    m.pass_pc.reset();
    m.current = at(m, 0);
}

}  // namespace puckloop::dspic
