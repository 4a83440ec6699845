// A dsPIC's schematic: which modules it has, and what leads from one to the other.

#include "emu/dspic/chip/chip_parts.h"

#include "emu/dspic/peripherals/timing/oscillator_33f.h"

#include <array>

namespace puckloop::dspic {

namespace {

constexpr std::size_t kRecords = 1000;

/// Instruction rate before the first configuration word is known.
double start_hertz(const DeviceInfo& device, const ChipOptions& options) {
    if (device.family_33f) return Oscillator33F::start_hertz();
    return decode_fosc(options.fosc.value_or(0xFFFF), options.crystal_hertz).hertz / device.clocks_per_cycle;
}

std::string_view reset_name(ResetCause cause) {
    switch (cause) {
    case ResetCause::PowerOn:
        return "POR";
    case ResetCause::BrownOut:
        return "BOR";
    case ResetCause::Mclr:
        return "EXTR";
    case ResetCause::Software:
        return "SWR";
    case ResetCause::Watchdog:
        return "WDTO";
    case ResetCause::TrapConflict:
        return "TRAPR";
    case ResetCause::IllegalOpcode:
        return "IOPUWR";
    }
    return "";
}

/// The timer's match starts conversions.
void wire_converter(Timer* source, void* converter, void (*trigger)(void* owner, Cycle at)) {
    source->on_match_owner = converter;
    source->on_match = trigger;
}

}  // namespace

Chip::Parts::Parts(const DeviceInfo& device_info, Pins& board, const ChipOptions& chip_options)
    : device(device_info),
      layout(layout_of(device)),
      pins(board),
      options(chip_options),
      clock(start_hertz(device, options), options.ppm),
      interrupts(device, described()),
      core(device, sfr, events, interrupts),
      around{sfr, events, core.cycle_counter(), interrupts},
      oscillator(make_oscillator()),
      ports(around, layout.ports, pins),
      external(around, ports, layout.external_irqs),
      held(events, &interrupts,
           [](void* owner, int irq, bool, Cycle due) {
               static_cast<InterruptController*>(owner)->set_flag(irq, due);
           }),
      edges(events.add(this,
                       [](void* owner, Cycle due) {
                           Parts& parts = *static_cast<Parts*>(owner);
                           parts.ports.sample_monitored(due);
                           parts.plan_edges(due);
                       })),
      supply(core, events, pins) {
    core.set_errata(options.errata);
    Timer* before = nullptr;
    for (const TimerPlace& place : layout.timers) {
        Timer* upper = place.setup.hold ? before : nullptr;
        before = &timers.emplace_back(around, place.setup, upper);
    }
    for (const Uart::Setup& setup : layout.uarts)
        uarts.emplace_back(around, setup, clock, ports, pins);
    if (layout.adc12) adc12.emplace(around, clock, pins);
    for (const I2cMaster::Setup& setup : layout.i2cs) {
        masters.emplace_back(around, setup, clock, ports, pins);
        slaves.emplace_back(around, setup, clock, pins);
        masters.back().attach(slaves.back());
    }
    for (const Adc33F::Setup& setup : layout.adcs)
        adcs.emplace_back(around, setup, clock, ports, pins);
    for (const Spi::Setup& setup : layout.spis)
        spis.emplace_back(around, setup, ports, pins);
    const std::array time_bases{timer(2), timer(3)};
    output_compare.emplace(around, layout.output_compare, time_bases, ports, pins);
    output_compare->set_errata(options.errata);
    input_capture.emplace(around, layout.input_captures, time_bases, clock, ports);
    if (!device.family_33f)
        for (Uart& uart : uarts)
            uart.attach(*input_capture);
    if (layout.dma.con)
        dma.emplace(around, layout.dma, core.ram().subspan((layout.dma.ram - device.ram_start) / 2u));
    if (layout.dci.con1) dci.emplace(around, layout.dci, clock, ports, pins);
    if (layout.low_voltage_irq) low_voltage.emplace(around, layout.low_voltage_irq, pins);
    for (const Can::Setup& setup : layout.cans)
        cans.emplace_back(around, setup, clock, ports, pins);
    for (const Ecan::Setup& setup : layout.ecans)
        ecans.emplace_back(around, setup, clock, ports, pins, *dma);
    for (const std::uint16_t address : layout.stored)
        sfr.claim(address);
    const auto address_of = [&](std::string_view name) {
        const RegisterInfo* info = sfr.find(name);
        return info ? info->address : std::uint16_t{0};
    };
    disable.emplace(sfr, layout, std::array{address_of("PMD1"), address_of("PMD2"), address_of("PMD3")});
    list_idle_controls();
    wire();
}

void Chip::Parts::list_idle_controls() {
    for (const TimerPlace& place : layout.timers)
        idle_controls.push_back(place.setup.con);
    for (const Uart::Setup& setup : layout.uarts)
        idle_controls.push_back(setup.mode);
    if (layout.adc12) idle_controls.push_back(Adc12::kControl);
    for (const Adc33F::Setup& setup : layout.adcs)
        idle_controls.push_back(setup.con1);
    for (const Spi::Setup& setup : layout.spis)
        idle_controls.push_back(setup.stat);
    if (dci) idle_controls.push_back(layout.dci.con1);
    for (const Can::Setup& setup : layout.cans)
        idle_controls.push_back(Can::control(setup));
    for (const Ecan::Setup& setup : layout.ecans)
        idle_controls.push_back(Ecan::control(setup));
}

std::unique_ptr<ClockControl> Chip::Parts::make_oscillator() {
    if (device.family_33f) return std::make_unique<Oscillator33F>(around, clock, options.crystal_hertz);
    return std::make_unique<Oscillator>(around, clock, options.crystal_hertz);
}

Timer* Chip::Parts::timer(int number) {
    for (std::size_t i = 0; i < timers.size(); ++i)
        if (layout.timers[i].number == number) return &timers[i];
    return nullptr;
}

void Chip::Parts::wire() {
    for (std::size_t i = 0; i < timers.size(); ++i) {
        const Ports::Pin pin = layout.timers[i].clock;
        ports.watch(
            pin.port, pin.number, &timers[i],
            [](void* owner, bool level, Cycle at) { static_cast<Timer*>(owner)->clock_pin(level, at); },
            [](const void* owner) { return static_cast<const Timer*>(owner)->monitors_clock_pin(); });
        timers[i].on_monitoring_owner = &ports;
        timers[i].on_monitoring = [](void* owner) { static_cast<Ports*>(owner)->monitoring_changed(); };
    }
    ports.on_monitoring_owner = this;
    ports.on_monitoring = [](void* owner, Cycle at) { static_cast<Parts*>(owner)->plan_edges(at); };
    if (adc12)
        wire_converter(timer(layout.adc_timers[0]), &*adc12, [](void* owner, Cycle at) {
            static_cast<Adc12*>(owner)->trigger(Adc12::Trigger::Timer3, at);
        });
    for (std::size_t i = 0; i < adcs.size(); ++i)
        wire_converter(timer(layout.adc_timers[i]), &adcs[i], [](void* owner, Cycle at) {
            static_cast<Adc33F*>(owner)->trigger(Adc33F::Trigger::Timer, at);
        });
    external.on_int0_owner = this;
    external.on_int0 = [](void* owner, Cycle at) {
        Parts& parts = *static_cast<Parts*>(owner);
        if (parts.adc12) parts.adc12->trigger(Adc12::Trigger::Int0, at);
        for (Adc33F& adc : parts.adcs)
            adc.trigger(Adc33F::Trigger::Int0, at);
    };
    if (adc12) {
        ports.before_change_owner = &*adc12;
        ports.before_change = [](void* owner, Cycle until) { static_cast<Adc12*>(owner)->catch_up(until); };
    }
    oscillator->on_rate_owner = this;
    oscillator->on_rate = [](void* owner, double hertz) {
        Parts& parts = *static_cast<Parts*>(owner);
        parts.core.set_cycle_rate(hertz);
        parts.core.end_run();
        if (parts.dci) parts.dci->rate_changed();
    };
    oscillator->on_doze = [](void* owner) { static_cast<Parts*>(owner)->core.doze_changed(); };
    core.set_cycle_rate(clock.hertz());
    core.set_reset_hook([this](ResetCause cause) { reset(cause); });
    if (low_voltage) core.set_rcon_hook([this] { low_voltage->changed(clock.hertz()); });
    core.set_power_hook([this](PowerMode mode) { set_power(mode); });
    core.observer().on_reset = [this](ResetCause cause, std::uint32_t pc, Cycle at) {
        if (!supply.holds() && report.resets.size() < kRecords)
            report.resets.push_back({at, std::string(reset_name(cause)), pc});
    };
    core.observer().on_trap = [this](Trap trap, std::uint32_t pc, Cycle at) {
        if (report.traps.size() < kRecords)
            report.traps.push_back({at, std::string(device.vector_name(static_cast<int>(trap))), pc});
    };
    core.observer().on_warning = [this](std::string_view text, std::uint32_t pc) {
        report.warnings.push_back({core.cycle(), std::string(text), pc});
    };
    sfr.on_first_touch = [this](std::string_view name, std::uint16_t address, bool write) {
        report.unmodelled.push_back({core.cycle(), std::string(name), address, core.pc(), write});
    };
}

}  // namespace puckloop::dspic
