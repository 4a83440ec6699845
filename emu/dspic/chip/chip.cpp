#include "emu/dspic/chip/chip.h"

#include "emu/dspic/chip/layout.h"
#include "emu/dspic/chip/module_disable.h"
#include "emu/dspic/chip/supply_reset.h"
#include "emu/dspic/core/core.h"
#include "emu/dspic/core/interrupts.h"
#include "emu/dspic/devices/dspic30f6014a_sfr.h"
#include "emu/dspic/devices/register_bits.h"
#include "emu/dspic/peripherals/adc12.h"
#include "emu/dspic/peripherals/dci.h"
#include "emu/dspic/peripherals/external_interrupts.h"
#include "emu/dspic/peripherals/i2c_slave.h"
#include "emu/dspic/peripherals/low_voltage.h"
#include "emu/dspic/peripherals/oscillator.h"
#include "emu/dspic/peripherals/oscillator_33f.h"
#include "emu/dspic/waits/judge.h"
#include "emu/dspic/waits/status_bits.h"
#include "emu/image/code_places.h"
#include "emu/image/device.h"
#include "emu/image/image.h"
#include "protocols/uart_sampling.h"

#include <algorithm>
#include <deque>
#include <stdexcept>

namespace puckloop::dspic {

using cosim::Time;

namespace {

/// "Stop in Idle" is in the same place in every module that has it.
constexpr RegisterBits kAnyModule{"*"};
constexpr std::uint32_t kFosc30F = 0xF80000;
constexpr std::uint32_t kFoscsel33F = 0xF80006;
constexpr std::uint32_t kFosc33F = 0xF80008;
constexpr std::size_t kRecords = 1000;
constexpr int kUartLookaheadBits = 9;
constexpr double kShortestWait = 0.1;  // s

/// Instruction rate before the first configuration word is known.
double start_hertz(const DeviceInfo& device, const ChipOptions& options) {
    if (device.family_33f) return Oscillator33F::start_hertz();
    return decode_fosc(options.fosc.value_or(0xFFFF), options.crystal_hertz).hertz / device.clocks_per_cycle;
}

constexpr Cycle later_cycle(Cycle cycle, Cycle by) {
    return cycle > kNoCycle - by ? kNoCycle : cycle + by;
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

}  // namespace

/// The schematic of the part.
struct Chip::Parts {
    const DeviceInfo& device;
    const Layout& layout;
    Pins& pins;
    ChipOptions options;
    cosim::ClockDomain clock;
    SfrSpace sfr;
    EventQueue events;
    InterruptController interrupts;
    Core core;
    Surroundings around;
    std::unique_ptr<ClockControl> oscillator;
    Ports ports;
    ExternalInterrupts external;
    std::deque<Timer> timers;  ///< in the layout's order
    std::deque<Uart> uarts;
    std::optional<Adc12> adc12;
    std::deque<I2cMaster> masters;
    std::deque<I2cSlave> slaves;
    std::deque<Adc33F> adcs;
    std::deque<Spi> spis;
    std::optional<OutputCompare> output_compare;
    std::optional<InputCapture> input_capture;
    std::optional<Dma> dma;
    std::optional<Dci> dci;
    std::optional<LowVoltage> low_voltage;
    std::deque<Can> cans;
    std::deque<Ecan> ecans;
    std::optional<ModuleDisable> disable;
    chip::HeldInterrupts held;
    EventQueue::Slot edges;  ///< that the board makes by itself; behind the others, which keep theirs
    SupplyReset supply;

    ChipReport report;
    image::CodePlaces places;
    std::vector<std::uint32_t> stops;
    std::optional<std::uint32_t> stopped_at;
    Time now = 0;    ///< the last `until`
    Time until = 0;  ///< of the run in progress
    Time pause = cosim::kNever;
    std::optional<Cycle> asleep_since;
    std::vector<std::uint16_t> idle_controls;  ///< registers with a bit that stops a module in Idle
    bool holding = true;                       ///< set_power() may have stopped a module

    Parts(const DeviceInfo& device_info, Pins& board, const ChipOptions& chip_options)
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
                               parts.ports.look_at_heeded(due);
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

    void list_idle_controls() {
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

    SfrSpace& described() {
        sfr.describe(device.registers);
        return sfr;
    }

    std::unique_ptr<ClockControl> make_oscillator() {
        if (device.family_33f) return std::make_unique<Oscillator33F>(around, clock, options.crystal_hertz);
        return std::make_unique<Oscillator>(around, clock, options.crystal_hertz);
    }

    void plan_edges(Cycle after) { events.schedule(edges, ports.next_edge(after)); }

    /// By the data sheet's number; null if the part has no such timer.
    Timer* timer(int number) {
        for (std::size_t i = 0; i < timers.size(); ++i)
            if (layout.timers[i].number == number) return &timers[i];
        return nullptr;
    }

    void wire() {
        for (std::size_t i = 0; i < timers.size(); ++i) {
            const Ports::Pin pin = layout.timers[i].clock;
            ports.watch(
                pin.port, pin.number, &timers[i],
                [](void* owner, bool level, Cycle at) { static_cast<Timer*>(owner)->clock_pin(level, at); },
                [](const void* owner) { return static_cast<const Timer*>(owner)->heeds_clock_pin(); });
            timers[i].on_heeding_owner = &ports;
            timers[i].on_heeding = [](void* owner) { static_cast<Ports*>(owner)->heeding_changed(); };
        }
        ports.on_heeding_owner = this;
        ports.on_heeding = [](void* owner, Cycle at) { static_cast<Parts*>(owner)->plan_edges(at); };
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
            ports.before_change = [](void* owner, Cycle until) {
                static_cast<Adc12*>(owner)->catch_up(until);
            };
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

    /// The timer's match starts conversions.
    static void wire_converter(Timer* source, void* converter, void (*trigger)(void* owner, Cycle at)) {
        source->on_match_owner = converter;
        source->on_match = trigger;
    }

    void supply_changed() {
        const Cycle at = message_cycle();
        const double start = supply.power_up_seconds() + oscillator->wake_seconds();
        supply.changed(at, static_cast<Cycle>(start * clock.hertz()));
        if (low_voltage) low_voltage->supply_changed(at);
    }

    ClockConfiguration clock_words() const {
        if (!device.family_33f) return {.fosc = options.fosc.value_or(core.config(kFosc30F))};
        return {.fosc = core.config(kFosc33F), .foscsel = core.config(kFoscsel33F)};
    }

    // Registers and modules at a reset; the core does its own and RCON.
    void reset(ResetCause cause) {
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
        ports.heeding_changed();
        supply.reset(cause);
    }

    // Sleep stops every module that needs the instruction clock, Idle those whose xSIDL bit says so.
    void set_power(PowerMode mode) {
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

    Uart& uart(int unit) { return uarts[static_cast<std::size_t>(unit - 1)]; }

    /// The cycle that messages handed in now belong to: the first that starts at or after the last `until`.
    Cycle message_cycle() const { return clock.first_cycle_at(now); }

    /// What the part remembers, once for saving and loading. Registers come first: modules look at them.
    template <class Archive>
    void state(Archive& archive) {
        if constexpr (!Archive::kRaw) {
            std::string part(device.name);
            archive(part);
            archive.check(part == device.name, "a state of another chip");
        }
        archive.part("clock", clock);
        archive.part("registers", sfr);
        if constexpr (Archive::kLoads) disable->restore();
        archive.part("core", core);
        if (device.family_33f)
            archive.part("oscillator", static_cast<Oscillator33F&>(*oscillator));
        else
            archive.part("oscillator", static_cast<Oscillator&>(*oscillator));
        archive.part("ports", ports);
        if constexpr (Archive::kLoads) interrupts.forget_rests();
        if constexpr (!Archive::kRaw && !Archive::kLoads)  // what rests is nobody's business
            if (const Cycle cycle = message_cycle(); cycle > 0)
                for (Timer& timer : timers)
                    timer.wake(cycle - 1);
        const auto parts_of = [&](const char* name, auto& modules) {
            for (std::size_t i = 0; i < modules.size(); ++i)
                archive.part(name, i + 1, modules[i]);
        };
        parts_of("timer", timers);
        parts_of("uart", uarts);
        if (adc12) archive.part("adc", *adc12);
        parts_of("i2c", masters);
        parts_of("i2c slave", slaves);
        parts_of("adc", adcs);
        parts_of("spi", spis);
        archive.part("output compare", *output_compare);
        archive.part("input capture", *input_capture);
        if (dma) archive.part("dma", *dma);
        if (dci) archive.part("dci", *dci);
        if (low_voltage) archive.part("low voltage", *low_voltage);
        parts_of("can", cans);
        parts_of("ecan", ecans);
        archive.part("report", report);
        archive(asleep_since);
        if constexpr (Archive::kLoads) holding = true;
        if constexpr (!Archive::kRaw) check_report(archive);
        archive.part("held interrupts", held);
        archive.part("supply", supply);
        archive.part("events", events);
        if constexpr (Archive::kLoads)
            for (Timer& timer : timers)
                timer.loaded();
        archive.bounded(now, 0, cosim::kNever);
        if constexpr (!Archive::kRaw) check_times(archive);
    }
    template <class Archive>
    void check_report(Archive& archive) const {
        const auto check_text = [&](const auto& records, auto text) {
            for (const auto& record : records)
                for (const char c : record.*text)
                    archive.check(c >= ' ' && c <= '~', "a record that is no text");
        };
        check_text(report.resets, &ResetRecord::cause);
        check_text(report.traps, &TrapRecord::name);
        check_text(report.unmodelled, &UnmodelledTouch::name);
        check_text(report.warnings, &ChipWarning::text);
    }
    template <class Archive>
    void check_times(Archive& archive) const {
        // An instruction is never cut in two, so the core may be somewhat ahead.
        constexpr Cycle kMostAhead = 1000;
        constexpr Time kAhead = 100 * cosim::kMillisecond;  // a CPU that dozes: cycles 128 times as long
        const Time reached = clock.time_of(core.cycle());
        archive.check(reached >= now && reached - now <= kAhead, "core and clock at different times");
        archive.check(later_cycle(events.next(), kMostAhead) >= core.cycle(), "an event long overdue");
    }

    Cycle until_cycle() const { return clock.first_cycle_at(until); }

    /// Run up to `time`: the outside may change from there on.
    void arrive(Time time) {
        now = std::max(now, time);
        const Cycle reached = std::min(message_cycle(), core.cycle());
        if (adc12 && reached > 0) adc12->catch_up(reached - 1);
    }
};

Chip::Chip(const DeviceInfo& device, Pins& pins, const ChipOptions& options)
    : parts_(std::make_unique<Parts>(device, pins, options)) {}

Chip::~Chip() = default;

void Chip::load(const image::Image& image) {
    image::check_fits(image, image::find_device(parts_->device.name));
    parts_->places = image::CodePlaces(image.symbols, image.file, image.sha256);
    std::vector<ProgramWord> words;
    for (const auto& [address, word] : image.all_words())
        words.push_back({address, word});
    parts_->core.load(words);
}

void Chip::load_word(std::uint32_t address, std::uint32_t word) {
    const ProgramWord one[] = {{address, word}};
    parts_->core.load(one);
}

std::map<std::uint32_t, std::uint32_t> Chip::memory() const {
    const DeviceInfo& device = parts_->device;
    std::map<std::uint32_t, std::uint32_t> words;
    const auto add = [&](std::uint32_t start, std::uint32_t count, std::uint32_t erased) {
        for (std::uint32_t address = start; address < start + 2 * count; address += 2)
            if (const std::uint32_t word = parts_->core.program(address); word != erased)
                words.emplace(address, word);
    };
    constexpr std::uint32_t kErasedFlash = 0xFFFFFF, kErasedEeprom = 0xFFFF, kEveryWord = 0x1000000;
    add(0, device.flash_end / 2, kErasedFlash);
    add(device.unit_id_start, device.unit_id_words, kErasedFlash);
    add(device.eeprom_start, device.eeprom_words, kErasedEeprom);
    add(device.config_start, device.config_words, kEveryWord);
    return words;
}

void Chip::power_on() {
    constexpr std::uint32_t kErased = 0xFFFFFF;
    if (parts_->core.program(0) == kErased)
        parts_->report.warnings.push_back({0, "no program at the reset vector: address 0 is erased", 0});
    parts_->core.reset(ResetCause::PowerOn);
}

void Chip::mclr() {
    parts_->core.reset(ResetCause::Mclr);
}

void Chip::run_until(Time until) {
    Parts& parts = *parts_;
    parts.stopped_at.reset();
    if (parts.pause <= parts.now) parts.pause = cosim::kNever;
    parts.until = std::min(until, parts.pause);
    // The rate may change on the way: then the cycle that starts at `until` is another one.
    for (Cycle limit = parts.until_cycle();; limit = parts.until_cycle()) {
        if (parts.core.run(limit) == Core::Outcome::Stopped) {
            parts.stopped_at = parts.core.pc();
            parts.arrive(std::min(parts.until, parts.clock.time_of(parts.core.cycle())));
            return;
        }
        if (parts.until_cycle() <= parts.core.cycle()) break;
    }
    parts.arrive(parts.until);
}

void Chip::pause_at(Time time) {
    parts_->pause = time;
    if (time >= parts_->until) return;
    parts_->until = time;
    parts_->core.end_run();
}

void Chip::stop_at(std::uint32_t pc) {
    parts_->stops.push_back(pc);
    parts_->core.set_stops(parts_->stops);
}

std::optional<std::uint32_t> Chip::stopped_at() const {
    return parts_->stopped_at;
}

void Chip::uart_receive(int unit, const cosim::UartFrame& frame) {
    parts_->uart(unit).receive(frame, parts_->message_cycle());
}

void Chip::i2c_answer(int unit, const cosim::I2cPhase& phase) {
    parts_->masters.at(static_cast<std::size_t>(unit - 1)).answer(phase, parts_->message_cycle());
}

void Chip::i2c_answer_at(int unit, const cosim::I2cPhase& phase, Time time) {
    const Cycle at = std::max(parts_->clock.first_cycle_at(time), parts_->core.cycle() + 1);
    parts_->masters.at(static_cast<std::size_t>(unit - 1)).answer_at(phase, at);
}

void Chip::edges_moved(Cycle at) {
    parts_->plan_edges(at == 0 ? 0 : at - 1);
}

void Chip::i2c_slave_phase(int unit, const cosim::I2cPhase& phase) {
    parts_->slaves.at(static_cast<std::size_t>(unit - 1)).phase(phase, parts_->message_cycle());
}

void Chip::stop_crystal() {
    Parts& parts = *parts_;
    if (parts.oscillator->crystal_stopped(parts.message_cycle())) return;
    parts.report.warnings.push_back(
        {parts.core.cycle(), "its crystal stopped, and no monitor watches it", pc()});
    parts.core.stall_until(kNoCycle);
}

void Chip::can_news(int unit, const cosim::CanMessage& message) {
    const auto module = static_cast<std::size_t>(unit - 1);
    if (!parts_->ecans.empty()) return parts_->ecans.at(module).news(message, parts_->message_cycle());
    parts_->cans.at(module).news(message, parts_->message_cycle());
}

void Chip::pins_changed(PortLetter port) {
    parts_->ports.outside_changed(port, parts_->message_cycle());
}

void Chip::supply_changed() {
    parts_->supply_changed();
}

Time Chip::earliest_uart_send(int unit, Time nominal_bit) const {
    const Time unbegun = now() + kUartLookaheadBits * nominal_bit;
    const std::optional<cosim::UartFrame> frame = parts_->uart(unit).begun();
    return frame ? std::min(unbegun, protocols::stop_bit_start(*frame)) : unbegun;
}

std::optional<Time> Chip::uart_begun(int unit) const {
    const std::optional<cosim::UartFrame> frame = parts_->uart(unit).begun();
    if (!frame) return std::nullopt;
    return frame->start;
}

UartCounters Chip::uart_counters(int unit) const {
    return parts_->uart(unit).counters();
}

bool Chip::uart_enabled(int unit) const {
    return parts_->uart(unit).enabled();
}

Time Chip::earliest_i2c(int unit) const {
    const I2cMaster& master = parts_->masters.at(static_cast<std::size_t>(unit - 1));
    const Cycle cycle = master.earliest(std::max(parts_->core.cycle(), parts_->message_cycle()));
    return cycle == kNoCycle ? cosim::kNever : parts_->clock.time_of(cycle);
}

Time Chip::earliest_i2c_slave_answer(int unit) const {
    const I2cSlave& slave = parts_->slaves.at(static_cast<std::size_t>(unit - 1));
    return slave.earliest_answer(std::max(parts_->core.cycle(), parts_->message_cycle()));
}

OutputCompareState Chip::output_compare(int unit) const {
    return parts_->output_compare->present(unit);
}

const cosim::ClockDomain& Chip::clock() const {
    return parts_->clock;
}

Time Chip::now() const {
    return parts_->now;
}

Cycle Chip::cycle() const {
    return parts_->core.cycle();
}

std::uint32_t Chip::pc() const {
    return parts_->core.pc();
}

const image::CodePlaces& Chip::places() const {
    return parts_->places;
}

std::uint16_t Chip::peek(std::string_view register_name) const {
    const RegisterInfo* info = parts_->sfr.find(register_name);
    if (!info) throw std::out_of_range("no register " + std::string(register_name));
    parts_->ports.refresh();
    for (Timer& timer : parts_->timers)
        timer.refresh();
    return parts_->sfr.quiet_read(info->address);
}

std::uint16_t Chip::peek_data(std::uint16_t address) const {
    const DeviceInfo& device = parts_->device;
    if (address < device.ram_start || address >= device.ram_end || address % 2)
        throw std::out_of_range("no RAM word at this address");
    return parts_->core.ram()[(address - device.ram_start) / 2u];
}

std::optional<WaitReport> Chip::waiting() const {
    const Parts& parts = *parts_;
    const WaitContext context{parts.device, parts.layout, parts.sfr, parts.interrupts,
                              parts.core,   parts.ports,  parts.pins};
    WaitReport report;
    if (parts.asleep_since) {
        report.asleep = true;
        report.hung = sleeps_for_ever(context);
        report.since = *parts.asleep_since;
        report.text = report.hung ? "and no interrupt can wake it" : "until an interrupt comes";
    } else if (const std::optional<Core::BusyLoop> loop = parts.core.busy_loop()) {
        report = judge(context, loop->finding, loop->level);
        report.since = loop->since;
    } else {
        return std::nullopt;
    }
    if (static_cast<double>(parts.core.cycle() - report.since) < kShortestWait * parts.clock.hertz())
        return std::nullopt;
    return report;
}

ChipReport Chip::report() const {
    ChipReport report = parts_->report;
    for (const MissingPoll& poll : parts_->core.missing_polls())
        report.missing_bits.push_back(
            {poll.cycle, poll.first, poll.last,
             register_text(*parts_->sfr.info(poll.condition.address), poll.condition.mask)});
    for (const I2cMaster& master : parts_->masters)
        for (const auto& [address, times] : master.refused())
            report.refused_addresses.push_back({master.unit(), address, times});
    report.instructions = parts_->core.instructions();
    report.cycles = parts_->core.cycle();
    return report;
}

std::size_t Chip::resets() const {
    return parts_->report.resets.size();
}

void Chip::state(StateWriter& archive) const {
    parts_->state(archive);
}

void Chip::state(StateReader& archive) {
    parts_->state(archive);
    parts_->interrupts.registers_loaded();
    parts_->stopped_at.reset();
}

void Chip::state(CheckpointWriter& archive) const {
    parts_->state(archive);
}

void Chip::state(CheckpointReader& archive) {
    parts_->state(archive);
    parts_->interrupts.registers_loaded();
}

void Chip::mark() {
    parts_->core.mark();
}

void Chip::rewind() {
    parts_->core.rewind();
}

void Chip::settle() {
    parts_->core.settle();
}

Chip::Inside Chip::inside() {
    Parts& parts = *parts_;
    return {parts.device, parts.core, parts.sfr, parts.interrupts, parts.clock, parts.held};
}

void Chip::set_stops(const std::vector<std::uint32_t>& addresses) {
    parts_->stops = addresses;
    parts_->core.set_stops(parts_->stops);
}

void Chip::set_skipping(bool on) {
    parts_->core.set_skip_idle(on);
    parts_->interrupts.set_resting(on);
}

}  // namespace puckloop::dspic
