// What a dsPIC's resets, its supply and its power modes do to the modules.

#include "emu/dspic/chip/chip_parts.h"
#include "emu/dspic/devices/dspic30f6014a_sfr.h"
#include "emu/dspic/devices/register_bits.h"

namespace puckloop::dspic {

namespace {

/// "Stop in Idle" is in the same place in every module that has it.
constexpr RegisterBits kAnyModule{"*"};
constexpr std::uint32_t kFosc30F = 0xF80000;
constexpr std::uint32_t kFoscsel33F = 0xF80006;
constexpr std::uint32_t kFosc33F = 0xF80008;

}  // namespace

void Chip::Parts::supply_changed() {
    const Cycle at = message_cycle();
    const double start = supply.power_up_seconds() + oscillator->wake_seconds();
    supply.changed(at, static_cast<Cycle>(start * clock.hertz()));
    if (low_voltage) low_voltage->supply_changed(at);
}

ClockConfiguration Chip::Parts::clock_words() const {
    if (!device.family_33f) return {.fosc = options.fosc.value_or(core.config(kFosc30F))};
    return {.fosc = core.config(kFosc33F), .foscsel = core.config(kFoscsel33F)};
}

void Chip::Parts::reset(ResetCause cause) {
    const bool power_on = cause == ResetCause::PowerOn;
    // What was converted until now draws its noise, wherever the run was looked at last.
    if (adc12 && core.cycle() > 0) adc12->catch_up(core.cycle() - 1);
    const std::uint16_t rcon = sfr.raw(sfr::RCON);
    sfr.reset_values();
    disable->restore();
    if (!power_on) sfr.raw(sfr::RCON) = rcon;
    oscillator->configure(clock_words());
    oscillator->reset(power_on || cause == ResetCause::BrownOut);
    ports.reset();
    const auto reset_all = [](auto& modules) {
        for (auto& module : modules)
            module.reset();
    };
    reset_all(timers);
    reset_all(uarts);
    if (adc12) adc12->reset();
    reset_all(masters);
    reset_all(slaves);
    reset_all(adcs);
    reset_all(spis);
    output_compare->reset();
    input_capture->reset();
    if (dma) dma->reset();
    if (dci) dci->reset();
    if (low_voltage) low_voltage->reset(supply.brown_out_on());
    reset_all(cans);
    reset_all(ecans);
    interrupts.reset();
    held.reset();
    ports.monitoring_changed();
    supply.reset(cause);
}

void Chip::Parts::set_power(PowerMode mode) {
    asleep_since.reset();
    if (mode != PowerMode::Run) asleep_since = core.cycle();
    if (mode == PowerMode::Sleep) core.set_wake_time(oscillator->wake_seconds());
    output_compare->hold(mode == PowerMode::Sleep, mode == PowerMode::Idle);
    input_capture->hold(mode == PowerMode::Sleep, mode == PowerMode::Idle);
    // Firmware that idles between interrupts comes by here twice for each of them.
    unsigned controls = 0;
    if (mode == PowerMode::Idle)
        for (const std::uint16_t address : idle_controls)
            controls |= sfr.raw(address);
    const bool holds = mode == PowerMode::Sleep || (controls & kAnyModule["*SIDL"]);
    if (!holds && !holding) return;
    holding = holds;
    const auto stops = [&](std::uint16_t control) {
        return mode == PowerMode::Sleep ||
               (mode == PowerMode::Idle && (sfr.raw(control) & kAnyModule["*SIDL"]));
    };
    for (std::size_t i = 0; i < timers.size(); ++i)
        timers[i].hold(stops(layout.timers[i].setup.con));
    for (std::size_t i = 0; i < uarts.size(); ++i)
        uarts[i].hold(stops(layout.uarts[i].mode));
    const bool sleeps = mode == PowerMode::Sleep;
    if (adc12) adc12->hold(stops(Adc12::kControl) && !(sleeps && adc12->runs_in_sleep()));
    for (std::size_t i = 0; i < adcs.size(); ++i)
        adcs[i].hold(stops(layout.adcs[i].con1) && !(sleeps && adcs[i].runs_in_sleep()));
    for (std::size_t i = 0; i < spis.size(); ++i)
        spis[i].hold(stops(layout.spis[i].stat));
    if (dci) dci->hold(stops(layout.dci.con1) && !(sleeps && dci->runs_in_sleep()));
    for (std::size_t i = 0; i < cans.size(); ++i)
        cans[i].hold(stops(Can::control(layout.cans[i])));
    for (std::size_t i = 0; i < ecans.size(); ++i)
        ecans[i].hold(stops(Ecan::control(layout.ecans[i])));
}

}  // namespace puckloop::dspic
