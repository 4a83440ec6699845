#include "emu/avr/chip.h"

#include "base/archive.h"
#include "base/checkpoint.h"

#include "emu/avr/peripherals/adc.h"
#include "emu/avr/peripherals/comparator.h"
#include "emu/avr/peripherals/eeprom.h"
#include "emu/avr/peripherals/external_interrupts.h"
#include "emu/avr/peripherals/ports.h"
#include "emu/avr/peripherals/self_programming.h"
#include "emu/avr/peripherals/spi.h"
#include "emu/avr/peripherals/system_control.h"
#include "emu/avr/peripherals/timer.h"
#include "emu/avr/peripherals/twi.h"
#include "emu/avr/peripherals/usart.h"
#include "emu/avr/peripherals/watchdog.h"
#include "emu/avr/supply_reset.h"
#include "emu/image/code_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>

namespace puckloop::avr {

namespace {

constexpr std::size_t kMostRecords = 1000;
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

template <class Record>
void keep(std::vector<Record>& records, Record record) {
    if (records.size() < kMostRecords) records.push_back(std::move(record));
}

}  // namespace

struct Chip::Parts {
    const DeviceInfo& device;
    ChipOptions options;
    Fuses fuses;
    cosim::ClockDomain clock;
    IoSpace io;
    EventQueue events;
    InterruptController interrupts;
    Core core;
    Surroundings around;
    WatchClock watch;
    Prescaler synchronous, asynchronous;
    SystemControl system;
    Ports ports;
    ExternalInterrupts external;
    Timer timer0, timer1, timer2, timer3;
    Usart usart0, usart1;
    Twi twi;
    Spi spi;
    Adc adc;
    Comparator comparator;
    Eeprom eeprom;
    Watchdog watchdog;
    SelfProgramming programming;
    chip::HeldInterrupts held;  ///< its slot and the supply's are the last: the others keep theirs
    SupplyReset supply;
    std::vector<std::uint16_t> stops;
    bool stopped = false;
    cosim::Time now = 0;
    ChipReport report;
    image::CodePlaces places;

    void keep_refused_spm(std::string_view why) {
        const std::string text = fmt::format("SPM writes nothing: {}", why);
        const bool known = std::any_of(report.warnings.begin(), report.warnings.end(),
                                       [&](const ChipWarning& warning) { return warning.text == text; });
        if (!known) keep(report.warnings, {text, 2u * core.pc()});
    }

    Parts(const DeviceInfo& info, Pins& pins, const ChipOptions& chosen)
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
    static IoSpace& described(IoSpace& space, const DeviceInfo& info) {
        space.describe(info.registers);
        return space;
    }

    void synchronise_timers() {
        for (Timer* timer : {&timer0, &timer1, &timer2, &timer3})
            timer->synchronise();
    }
    void connect_hooks() {
        CoreHooks& hooks = core.hooks();
        hooks.reset = [this](ResetCause cause) { reset(cause); };
        hooks.reset_pc = [this] { return system.reset_pc(); };
        hooks.vector_base = [this] { return system.vector_base(); };
        hooks.interrupts_locked = [this] {
            return system.interrupts_held() || programming.interrupts_locked();
        };
        hooks.sleep = [this] { system.sleep(); };
        hooks.wake = [this] { system.wake(); };
        hooks.watchdog_reset = [this] { watchdog.restart(); };
        hooks.spm = [this](std::uint32_t address, std::uint16_t word) {
            if (const std::string_view why = programming.spm(address, word); !why.empty())
                keep_refused_spm(why);
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
        system.jtag_changed = [this] { lend_to_jtag(); };
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
                 {"ASSR.AS2 is set, but there is no crystal at TOSC1: timer 2 stands still", 2u * core.pc()});
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
    /// PC2 to PC5 are TCK, TMS, TDO and TDI.
    void lend_to_jtag() {
        constexpr std::uint8_t kPins = 0x3C;
        ports.lend(PortLetter::C, kPins, system.jtag());
    }

    // Sources of the ADC's trigger by ADTS2:0; the comparator (1) calls by itself.
    struct Trigger {
        unsigned number;
        InterruptFlags* flags;
        std::uint8_t mask;
    };
    std::array<Trigger, 6> triggers() {
        constexpr std::uint8_t kTov = bit(0), kOcfA = bit(1), kOcfB = bit(2), kIcf = bit(5), kIntf0 = bit(0);
        return {{{2, &external.edges(), kIntf0},
                 {3, &timer0.flags(), kOcfA},
                 {4, &timer0.flags(), kTov},
                 {5, &timer1.flags(), kOcfB},
                 {6, &timer1.flags(), kTov},
                 {7, &timer1.flags(), kIcf}}};
    }
    const Trigger* trigger_of(unsigned number) {
        sources = triggers();
        const auto found = std::find_if(sources.begin(), sources.end(),
                                        [&](const Trigger& trigger) { return trigger.number == number; });
        return found == sources.end() ? nullptr : &*found;
    }
    void watch_triggers(bool plan) {
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
    std::array<Trigger, 6> sources{};

    void connect_reports() {
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

    void reset(ResetCause cause) {
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
        lend_to_jtag();
        held.reset();
        supply.reset(cause);
        if (supply.holds()) watchdog.stop();
    }

    // PSRSYNC, PSRASY: the prescaler starts again; with TSM it stays at 0.
    static void write_gtccr(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t) {
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

    template <class Archive>
    void state(Archive& archive) {
        if constexpr (!Archive::kRaw) {
            std::string part(device.name);
            archive(part);
            archive.check(part == device.name, "a state of another chip");
        }
        archive.part("clock", clock);
        archive.part("registers", io);
        archive.part("timetable", events);
        archive.part("core", core);
        archive.part("interrupts", interrupts);
        archive.part("fuses", fuses);
        archive.part("system", system);
        archive.part("prescaler", synchronous);
        archive.part("prescaler2", asynchronous);
        archive.part("watch", watch);
        archive.part("ports", ports);
        archive.part("timer0", timer0);
        archive.part("timer1", timer1);
        archive.part("timer2", timer2);
        archive.part("timer3", timer3);
        archive.part("usart0", usart0);
        archive.part("usart1", usart1);
        archive.part("twi", twi);
        archive.part("spi", spi);
        archive.part("adc", adc);
        archive.part("eeprom", eeprom);
        archive.part("watchdog", watchdog);
        archive.part("programming", programming);
        archive.part("held interrupts", held);
        archive.bounded(now, 0, cosim::kNever);
        archive.part("supply", supply);
        if constexpr (Archive::kLoads) {
            adc.set_avcc(supply.volts());
            watch_triggers(false);
        }
        if constexpr (Archive::kRaw)
            archive.grows(report.resets, report.unmodelled, report.warnings);
        else
            archive(report.resets, report.unmodelled, report.warnings);
    }

    Usart& usart(int unit) { return unit == 0 ? usart0 : usart1; }
    /// What is handed in from outside happens now.
    void at_present() { core.set_now(std::max(core.now(), clock.first_cycle_at(now))); }
};

Chip::Chip(const DeviceInfo& device, Pins& pins, const ChipOptions& options)
    : parts_(std::make_unique<Parts>(device, pins, options)) {}
Chip::~Chip() = default;

const image::CodePlaces& Chip::places() const {
    return parts_->places;
}

void Chip::load(const image::AvrImage& image) {
    parts_->places = image::CodePlaces(image.symbols, image.file, image.sha256);
    for (const image::ByteSegment& segment : image.flash)
        for (std::size_t i = 0; i < segment.bytes.size(); ++i) {
            const auto address = static_cast<std::uint32_t>(segment.address + i);
            const std::uint16_t old = parts_->core.program(address / 2);
            const std::uint16_t byte = segment.bytes[i];
            parts_->core.set_program(
                address / 2,
                static_cast<std::uint16_t>(address & 1 ? (old & 0x00FF) | byte << 8 : (old & 0xFF00) | byte));
        }
    for (const image::ByteSegment& segment : image.eeprom)
        std::copy(segment.bytes.begin(), segment.bytes.end(),
                  parts_->eeprom.bytes().begin() + static_cast<std::ptrdiff_t>(segment.address));
    Fuses& fuses = parts_->fuses;
    std::uint8_t* const places[] = {&fuses.low, &fuses.high, &fuses.extended};
    for (std::size_t i = 0; i < std::min<std::size_t>(image.fuses.size(), std::size(places)); ++i)
        *places[i] = image.fuses[i];
    if (image.lock_bits) fuses.lock = *image.lock_bits;
}

image::AvrImage Chip::memory() const {
    image::AvrImage image;
    image::ByteSegment flash;
    for (std::uint32_t word = 0; word < parts_->device.flash_words; ++word) {
        const std::uint16_t value = parts_->core.program(word);
        flash.bytes.push_back(static_cast<std::uint8_t>(value));
        flash.bytes.push_back(static_cast<std::uint8_t>(value >> 8));
    }
    image.flash.push_back(std::move(flash));
    image.eeprom.push_back({0, parts_->eeprom.bytes()});
    const Fuses& fuses = parts_->fuses;
    image.fuses = {fuses.low, fuses.high, fuses.extended};
    image.lock_bits = fuses.lock;
    return image;
}

std::vector<std::uint8_t>& Chip::eeprom() {
    return parts_->eeprom.bytes();
}
const Fuses& Chip::fuses() const {
    return parts_->fuses;
}

void Chip::set_fuses(const Fuses& fuses) {
    parts_->fuses = fuses;
}

void Chip::power_on() {
    Parts& p = *parts_;
    constexpr std::uint8_t kClockOut = bit(6);  // CKOUT, programmed = 0
    if (!(p.fuses.low & kClockOut))
        keep(p.report.warnings, {"fuse CKOUT is programmed: the clock at PB1 has no model", 0});
    parts_->core.reset(ResetCause::PowerOn);
}
void Chip::external_reset() {
    parts_->at_present();
    parts_->core.request_reset(ResetCause::External);
}

void Chip::reset_now() {
    parts_->at_present();
    parts_->core.reset(ResetCause::External);
}

void Chip::set_supply(double volts) {
    parts_->at_present();
    parts_->adc.set_avcc(volts);
    parts_->supply.set(volts, parts_->core.now());
}

double Chip::supply() const {
    return parts_->supply.volts();
}

void Chip::run_until(cosim::Time until) {
    Parts& p = *parts_;
    p.stopped = false;
    while (true) {  // a change of the clock's rate ends a run early: its end is another cycle now
        const Cycle end = p.clock.first_cycle_at(until);
        const Core::Outcome outcome = p.core.run(end);
        if (outcome == Core::Outcome::Stopped) {
            p.stopped = true;
            p.now = std::min(until, p.clock.time_of(p.core.cycle()));
            return;
        }
        if (p.core.cycle() >= p.clock.first_cycle_at(until)) break;
    }
    p.now = until;
}

void Chip::stop_at(std::uint32_t pc) {
    parts_->stops.push_back(static_cast<std::uint16_t>(pc / 2));
    parts_->core.set_stops(parts_->stops);
}
std::optional<std::uint32_t> Chip::stopped_at() const {
    if (!parts_->stopped) return std::nullopt;
    return pc();
}

void Chip::uart_receive(int unit, const cosim::UartFrame& frame) {
    parts_->at_present();
    parts_->usart(unit).receive(frame, parts_->core.now());
}
void Chip::twi_answer(const cosim::I2cPhase& phase) {
    parts_->at_present();
    parts_->twi.answer(phase);
}
void Chip::twi_answer_at(const cosim::I2cPhase& phase, cosim::Time time) {
    parts_->twi.answer_at(phase, parts_->clock.first_cycle_at(time));
}
void Chip::twi_slave_phase(const cosim::I2cPhase& phase) {
    parts_->at_present();
    parts_->twi.slave_phase(phase);
}
void Chip::pins_changed(PortLetter port) {
    parts_->at_present();
    parts_->ports.pins_changed(port);
    parts_->comparator.update();
}
cosim::Time Chip::earliest_twi_slave_answer() const {
    const Parts& p = *parts_;
    const Cycle cycle = p.twi.earliest_slave_answer(std::max(p.core.cycle(), p.clock.first_cycle_at(p.now)));
    return cycle == kNoCycle ? cosim::kNever : p.clock.time_of(cycle);
}

std::optional<cosim::Time> Chip::uart_begun(int unit) const {
    const auto frame = parts_->usart(unit).begun();
    if (!frame) return std::nullopt;
    return frame->start;
}
const chip::UartCounters& Chip::uart_counters(int unit) const {
    return parts_->usart(unit).counters();
}
bool Chip::uart_listens(int unit) const {
    return parts_->usart(unit).receiving();
}
bool Chip::pin_level(Pin pin) const {
    return parts_->ports.level(pin);
}

const cosim::ClockDomain& Chip::clock() const {
    return parts_->clock;
}
cosim::Time Chip::now() const {
    return parts_->now;
}
Cycle Chip::cycle() const {
    return parts_->core.cycle();
}
std::uint32_t Chip::pc() const {
    return 2u * parts_->core.pc();
}
bool Chip::sleeping() const {
    return parts_->core.sleeping();
}
cosim::Time Chip::wakes() const {
    const Parts& p = *parts_;
    if (!p.core.rests()) return p.now;
    const Cycle next = p.events.next();
    return next == kNoCycle ? cosim::kNever : std::max(p.now, p.clock.time_of(next));
}
std::uint8_t Chip::peek(std::string_view register_name) const {
    const RegisterInfo* info = parts_->io.find(register_name);
    if (!info) throw std::out_of_range("no register " + std::string(register_name));
    return parts_->io.raw(info->address);
}
std::uint8_t Chip::look(std::uint16_t address) const {
    parts_->at_present();
    return parts_->io.quiet_read(address);
}
std::uint8_t Chip::peek_data(std::uint16_t address) const {
    const DeviceInfo& device = parts_->device;
    if (address < device.ram_start || address >= device.ram_end()) throw std::out_of_range("no RAM there");
    return parts_->core.ram()[address - device.ram_start];
}

void Chip::state(StateWriter& archive) const {
    parts_->state(archive);
}
void Chip::state(StateReader& archive) {
    parts_->state(archive);
    parts_->stopped = false;
}
void Chip::state(CheckpointWriter& archive) const {
    parts_->state(archive);
}
void Chip::state(CheckpointReader& archive) {
    parts_->state(archive);
    parts_->stopped = false;
}

void Chip::mark() {
    parts_->core.mark();
    parts_->eeprom.mark();
}
void Chip::rewind() {
    parts_->core.rewind();
    parts_->eeprom.rewind();
}
void Chip::settle() {
    parts_->core.settle();
    parts_->eeprom.settle();
}

Chip::Inside Chip::inside() {
    Parts& p = *parts_;
    p.at_present();
    return {p.device, p.core, p.io, p.interrupts, p.clock, p.eeprom, p.held};
}

void Chip::set_stops(const std::vector<std::uint32_t>& addresses) {
    parts_->stops.clear();
    for (const std::uint32_t pc : addresses)
        parts_->stops.push_back(static_cast<std::uint16_t>(pc / 2));
    parts_->core.set_stops(parts_->stops);
}

void Chip::set_skipping(bool on) {
    parts_->core.set_skip_idle(on);
}

void Chip::set_translating(bool on) {
    parts_->core.set_translate(on);
}

std::optional<std::string> Chip::hang() const {
    const Parts& p = *parts_;
    constexpr double kLong = 0.5;
    const auto seconds = [&](Cycle from) {
        return cosim::to_seconds(p.clock.time_of(p.core.cycle()) - p.clock.time_of(from));
    };
    const std::optional<WaitingLoop> loop = p.core.waiting();
    if (!loop || seconds(loop->since) < kLong) return std::nullopt;
    const bool masked = !(p.core.state().sreg & sreg::I);
    constexpr std::uint16_t kTwcr = 0xBC, kAdcsra = 0x7A;
    const RegisterInfo* polled = loop->polled ? p.io.info(loop->polled) : nullptr;
    std::string why;
    if (loop->polled == kTwcr && p.twi.idle())
        why = "reading TWCR, but the two-wire interface has nothing to do";
    else if (loop->polled == kAdcsra && !p.adc.converting())
        why = "reading ADCSRA, but no conversion is under way";
    else if (!polled && loop->reads_ram && masked)
        why = "reading RAM that only an interrupt could change, with interrupts off";
    else
        return std::nullopt;
    return fmt::format("has run {:.1f} s in the loop 0x{:04x}..0x{:04x} {}", seconds(loop->since),
                       2u * loop->head, 2u * loop->branch, why);
}

ChipReport Chip::report() const {
    ChipReport report = parts_->report;
    report.instructions = parts_->core.instructions();
    report.cycles = parts_->core.cycle();
    report.skipped = parts_->core.skipped();
    report.refused_addresses = parts_->twi.refused();
    return report;
}

std::optional<std::string> refused_text(const ChipReport& report) {
    const auto& addresses = report.refused_addresses;
    constexpr std::size_t kFew = 4;
    if (addresses.empty()) return std::nullopt;
    if (addresses.size() > kFew)
        return fmt::format("addressed {} addresses on the two-wire bus that nobody acknowledged",
                           addresses.size());
    return fmt::format("addressed 0x{:02x} on the two-wire bus, and nobody acknowledged",
                       fmt::join(addresses, ", 0x"));
}

}  // namespace puckloop::avr
