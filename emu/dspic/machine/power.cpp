// RCON, Sleep and Idle, and the watchdog timer.
// Source: family reference manual, "Watchdog timer and power saving modes"; fact sheet peripherals
// section 10. Deviations:
//   1. cycles go on counting in Sleep, as the chip's measure of time; modules see the mode through the hook.
//   2. a device without a programmed FWDT word runs with FWDTEN = 0 (erased silicon: 1).

#include "emu/dspic/devices/dspic30f6014a_sfr.h"
#include "emu/dspic/machine/machine.h"

namespace puckloop::dspic {

namespace {

constexpr std::uint32_t kFwdt30F = 0xF80002;
constexpr std::uint32_t kFwdt33F = 0xF8000A;

std::uint32_t fwdt(const Machine& m) {
    const std::uint32_t address = m.device.family_33f ? kFwdt33F : kFwdt30F;
    return m.config[(address - m.device.config_start) / 2];
}
bool watchdog_on(const Machine& m) {
    if (m.sfr.raw(sfr::RCON) & rcon::SWDTEN) return true;
    return fwdt(m) & (m.device.family_33f ? 1u << 7 : 1u << 15);
}

/// Nominal period in seconds from the configuration word.
double watchdog_period(const Machine& m) {
    if (m.device.family_33f) {
        constexpr double kLprc = 32768.0;
        const double prescale = fwdt(m) & 1u << 4 ? 128.0 : 32.0;
        return prescale * static_cast<double>(1u << (fwdt(m) & 15)) / kLprc;
    }
    constexpr double kShortest = 2e-3;
    static constexpr double kPrescaleA[4] = {1, 8, 64, 512};
    return kShortest * kPrescaleA[fwdt(m) >> 4 & 3] * static_cast<double>((fwdt(m) & 15) + 1);
}

void expired(void* owner, Cycle due) {
    auto& m = *static_cast<Machine*>(owner);
    if (m.mode == PowerMode::Run) return request_reset(m, ResetCause::Watchdog);
    (void)due;
    m.sfr.raw(sfr::RCON) |= rcon::WDTO;
    leave_power_save(m);
}

void write_rcon(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    auto& m = *static_cast<Machine*>(owner);
    std::uint16_t& stored = m.sfr.raw(address);
    const std::uint16_t before = stored;
    const unsigned writable = mask & ~std::uint32_t{rcon::BGST};
    stored = static_cast<std::uint16_t>((stored & ~writable) | (value & writable));
    if ((before ^ stored) & rcon::SWDTEN) clear_watchdog(m);
    if (m.rcon_hook) m.rcon_hook();
}

void set_mode(Machine& m, PowerMode mode) {
    m.mode = mode;
    m.limit = 0;
    if (m.power_hook) m.power_hook(mode);
}

}  // namespace

std::uint16_t& rcon_register(Machine& m) {
    return m.sfr.raw(sfr::RCON);
}

void hook_power(Machine& m) {
    m.sfr.hook(sfr::RCON, &m, nullptr, &write_rcon);
    m.watchdog_slot = m.events.add(&m, &expired);
}

void schedule_watchdog(Machine& m) {
    if (m.cycle_rate <= 0.0 || m.held || !watchdog_on(m)) return m.events.cancel(m.watchdog_slot);
    m.events.schedule(m.watchdog_slot,
                      m.watchdog_cleared + static_cast<Cycle>(watchdog_period(m) * m.cycle_rate));
}

void clear_watchdog(Machine& m) {
    m.watchdog_cleared = m.st.cycle;
    schedule_watchdog(m);
    m.bound_limit();
}

void enter_power_save(Machine& m, PowerMode mode) {
    std::uint16_t& flags = m.sfr.raw(sfr::RCON);
    flags = static_cast<std::uint16_t>((flags & ~rcon::WDTO) |
                                       (mode == PowerMode::Idle ? rcon::IDLE : rcon::SLEEP));
    clear_watchdog(m);
    set_mode(m, mode);
}

void leave_power_save(Machine& m) {
    m.wake_end = kNoCycle;
    clear_watchdog(m);
    set_mode(m, PowerMode::Run);
}

}  // namespace puckloop::dspic
