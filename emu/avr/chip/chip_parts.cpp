// The ATmega1284P's schematic: where its modules' registers, interrupts and pins are, and what leads from one
// to the other.

#include "emu/avr/chip/chip_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>

namespace puckloop::avr {

namespace {

constexpr std::uint16_t kAcsr = 0x50, kMcusr = 0x54, kAssr = 0xB6, kGtccr = 0x43, kPrr0 = 0x64, kPrr1 = 0x65;
using P = PortLetter;
constexpr std::array<std::uint16_t, 8> kSynchronousDividers = {0, 1, 8, 64, 256, 1024, 0, 0};
constexpr std::array<std::uint16_t, 8> kTimer2Dividers = {0, 1, 8, 32, 64, 128, 256, 1024};

const Timer::Setup kTimer0{false,
                           0x44,
                           0x46,
                           0,
                           0x47,
                           0x48,
                           0,
                           {0x35, 0x6E, {18, 16, 17, -1, -1, -1, -1, -1}},
                           kSynchronousDividers,
                           {Pin{P::B, 3}, Pin{P::B, 4}},
                           Pin{P::B, 0},
                           std::nullopt,
                           kPrr0,
                           bit(5)};
const Timer::Setup kTimer1{true,
                           0x80,
                           0x84,
                           0x86,
                           0x88,
                           0x8A,
                           0x82,
                           {0x36, 0x6F, {15, 13, 14, -1, -1, 12, -1, -1}},
                           kSynchronousDividers,
                           {Pin{P::D, 5}, Pin{P::D, 4}},
                           Pin{P::B, 1},
                           Pin{P::D, 6},
                           kPrr0,
                           bit(3)};
const Timer::Setup kTimer2{false,
                           0xB0,
                           0xB2,
                           0,
                           0xB3,
                           0xB4,
                           0,
                           {0x37, 0x70, {11, 9, 10, -1, -1, -1, -1, -1}},
                           kTimer2Dividers,
                           {Pin{P::D, 7}, Pin{P::D, 6}},
                           std::nullopt,
                           std::nullopt,
                           kPrr0,
                           bit(6),
                           kAssr,
                           Pin{P::C, 6},
                           Pin{P::C, 7}};
const Timer::Setup kTimer3{true,
                           0x90,
                           0x94,
                           0x96,
                           0x98,
                           0x9A,
                           0x92,
                           {0x38, 0x71, {34, 32, 33, -1, -1, 31, -1, -1}},
                           kSynchronousDividers,
                           {Pin{P::B, 6}, Pin{P::B, 7}},
                           Pin{P::D, 0},
                           Pin{P::B, 5},
                           kPrr1,
                           bit(0)};
constexpr Usart::Setup kUsart0{0, 0xC0, 20, Pin{P::D, 0}, Pin{P::D, 1}, Pin{P::B, 0}, bit(1)};
constexpr Usart::Setup kUsart1{1, 0xC8, 28, Pin{P::D, 2}, Pin{P::D, 3}, Pin{P::D, 4}, bit(4)};

}  // namespace

Chip::Parts::Parts(const DeviceInfo& info, Pins& pins, const ChipOptions& chosen)
    : device(info),
      options(chosen),
      fuses(chosen.fuses),
      clock(chosen.oscillator_hertz, chosen.ppm),
      core(info, described(io, info), events, interrupts),
      around{io, events, interrupts, core.now()},
      watch(clock, chosen.watch_hertz),
      asynchronous(&watch),
      system(around, core, clock, fuses, chosen.oscillator_hertz),
      ports(around, pins),
      external(around, ports),
      timer0(around, kTimer0, synchronous, ports),
      timer1(around, kTimer1, synchronous, ports),
      timer2(around, kTimer2, asynchronous, ports, &watch),
      timer3(around, kTimer3, synchronous, ports),
      usart0(around, kUsart0, clock, ports, pins),
      usart1(around, kUsart1, clock, ports, pins),
      twi(around, clock, ports, pins),
      spi(around, ports, pins),
      adc(around, pins, {chosen.avcc, chosen.aref}),
      comparator(around, pins, timer1, adc),
      eeprom(around, core, clock, info.eeprom_bytes),
      watchdog(around, core, clock),
      programming(around, core, clock, fuses, system),
      held(events, &interrupts,
           [](void* owner, int vector, bool lost, Cycle) {
               auto& controller = *static_cast<InterruptController*>(owner);
               lost ? controller.lose(vector) : controller.release(vector);
           }),
      supply(core, events, system, fuses, clock, chosen.avcc) {
    io.hook(kGtccr, this, nullptr, &write_gtccr);
    connect_hooks();
    connect_reports();
}

void Chip::Parts::keep_refused_spm(std::string_view why) {
    const std::string text = fmt::format("SPM writes nothing: {}", why);
    const bool known = std::any_of(report.warnings.begin(), report.warnings.end(),
                                   [&](const ChipWarning& warning) { return warning.text == text; });
    if (!known) keep(report.warnings, {text, 2u * core.pc()});
}

void Chip::Parts::synchronise_timers() {
    for (Timer* timer : {&timer0, &timer1, &timer2, &timer3})
        timer->synchronise();
}

void Chip::Parts::connect_hooks() {
    CoreHooks& hooks = core.hooks();
    hooks.reset = [this](ResetCause cause) { reset(cause); };
    hooks.reset_pc = [this] { return system.reset_pc(); };
    hooks.vector_base = [this] { return system.vector_base(); };
    hooks.interrupts_locked = [this] { return system.interrupts_held() || programming.interrupts_locked(); };
    hooks.sleep = [this] { system.sleep(); };
    hooks.wake = [this] { system.wake(); };
    hooks.watchdog_reset = [this] { watchdog.restart(); };
    hooks.spm = [this](std::uint32_t address, std::uint16_t word) {
        if (const std::string_view why = programming.spm(address, word); !why.empty()) keep_refused_spm(why);
    };
    hooks.load_program = [this](std::uint32_t address, std::uint8_t& value) {
        return programming.load(address, value);
    };
    system.synchronise = [this] { synchronise_timers(); };
    system.stop_clocks = [this](bool stopped, bool timer2_too) {
        synchronise_timers();
        synchronous.stop(stopped);
        if (timer2_too) asynchronous.stop(stopped);
        synchronise_timers();
    };
    system.jtag_changed = [this] { give_pins_to_jtag(); };
    system.pull_ups_changed = [this] { ports.refresh(); };
    system.quiet_conversion = [this] { adc.quiet(); };
    system.brown_out_on = [this] { supply.detector_on(); };
    system.rate_changes = [this](bool changed) {
        synchronise_timers();
        watchdog.rate_changes(changed);
        eeprom.rate_changes(changed);
        programming.rate_changes(changed);
    };
    watch.missing = [this] {
        keep(report.warnings,
             {"ASSR.AS2 is set, but there is no crystal at TOSC1: timer 2 does not count", 2u * core.pc()});
    };
    adc.source_changed = [this] { watch_triggers(true); };
    adc.source_set = [this](unsigned number) {
        const Trigger* trigger = trigger_of(number);
        if (!trigger) return number == 1 && (io.raw(kAcsr) & bit(4));
        return (trigger->flags->flags() & trigger->mask) != 0;
    };
    adc.input_changed = [this] { comparator.update(); };
    ports.listen(this, [](void* owner, PortLetter, std::uint8_t, std::uint8_t, Cycle) {
        static_cast<Parts*>(owner)->comparator.update();
    });
}

void Chip::Parts::give_pins_to_jtag() {
    constexpr std::uint8_t kPins = 0x3C;
    ports.take_over(PortLetter::C, kPins, system.jtag());
}

std::array<Chip::Parts::Trigger, 6> Chip::Parts::triggers() {
    constexpr std::uint8_t kTov = bit(0), kOcfA = bit(1), kOcfB = bit(2), kIcf = bit(5), kIntf0 = bit(0);
    return {{{2, &external.edges(), kIntf0},
             {3, &timer0.flags(), kOcfA},
             {4, &timer0.flags(), kTov},
             {5, &timer1.flags(), kOcfB},
             {6, &timer1.flags(), kTov},
             {7, &timer1.flags(), kIcf}}};
}

const Chip::Parts::Trigger* Chip::Parts::trigger_of(unsigned number) {
    sources = triggers();
    const auto found = std::find_if(sources.begin(), sources.end(),
                                    [&](const Trigger& trigger) { return trigger.number == number; });
    return found == sources.end() ? nullptr : &*found;
}

void Chip::Parts::watch_triggers(bool plan) {
    const Trigger* wanted = trigger_of(adc.trigger_source());
    for (InterruptFlags* flags : {&external.edges(), &timer0.flags(), &timer1.flags()})
        flags->watch(
            wanted && wanted->flags == flags ? wanted->mask : std::uint8_t{0}, this,
            [](void* owner) {
                auto& self = *static_cast<Parts*>(owner);
                self.adc.trigger(self.adc.trigger_source());
            },
            plan);
}

void Chip::Parts::connect_reports() {
    io.on_first_touch = [this](std::string_view name, std::uint16_t address, bool write) {
        keep(report.unmodelled, {std::string(name), address, write, 2u * core.pc()});
    };
    core.observer().on_warning = [this](std::string_view text, std::uint16_t pc) {
        keep(report.warnings, {std::string(text), 2u * pc});
    };
    core.observer().on_reset = [this](ResetCause cause, std::uint16_t pc, Cycle cycle) {
        if (!supply.holds()) keep(report.resets, {cause, 2u * pc, cycle});
    };
}

void Chip::Parts::reset(ResetCause cause) {
    const std::uint8_t flags = io.raw(kMcusr);  // MCUSR outlives a reset
    io.reset_values();
    io.raw(kMcusr) = flags;
    system.reset(cause);
    ports.reset();
    for (Timer* timer : {&timer0, &timer1, &timer2, &timer3})
        timer->reset();
    for (Prescaler* prescaler : {&synchronous, &asynchronous}) {
        prescaler->stop(false);
        prescaler->reset(core.now(), false);
    }
    usart0.reset();
    usart1.reset();
    twi.reset();
    spi.reset();
    adc.reset();
    comparator.reset();
    eeprom.reset();
    watchdog.reset(fuses.watchdog_always());
    programming.reset();
    give_pins_to_jtag();
    held.reset();
    supply.reset(cause);
    if (supply.holds()) watchdog.stop();
}

void Chip::Parts::write_gtccr(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t) {
    auto& self = *static_cast<Parts*>(owner);
    constexpr std::uint8_t kTsm = bit(7), kPsrasy = bit(1), kPsrsync = bit(0);
    const std::uint8_t old = self.io.raw(address);
    const bool held = value & kTsm;
    self.synchronise_timers();
    if ((value | old) & kPsrsync) self.synchronous.reset(self.core.now(), held && (value & kPsrsync));
    if ((value | old) & kPsrasy) self.asynchronous.reset(self.core.now(), held && (value & kPsrasy));
    self.io.raw(address) = held ? value & (kTsm | kPsrasy | kPsrsync) : 0;
    self.synchronise_timers();
}

}  // namespace puckloop::avr
