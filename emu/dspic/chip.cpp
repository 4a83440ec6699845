#include "emu/dspic/chip.h"

#include "emu/dspic/core.h"
#include "emu/dspic/devices/dspic30f6014a_irq.h"
#include "emu/dspic/devices/dspic30f6014a_sfr.h"
#include "emu/dspic/interrupts.h"
#include "emu/dspic/peripherals/adc12.h"
#include "emu/dspic/peripherals/external_interrupts.h"
#include "emu/dspic/peripherals/i2c_master.h"
#include "emu/dspic/peripherals/oscillator.h"
#include "emu/dspic/peripherals/ports.h"
#include "emu/dspic/peripherals/timer.h"
#include "emu/dspic/peripherals/uart.h"
#include "emu/image/device.h"
#include "emu/image/image.h"
#include "protocols/uart_sampling.h"

#include <algorithm>
#include <stdexcept>

namespace puckloop::dspic {

using cosim::Time;

namespace {

constexpr std::uint32_t kFosc = 0xF80000;
constexpr std::size_t kRecords = 1000;
constexpr int kUartLookaheadBits = 9;
constexpr std::uint16_t kStopInIdle = bit(13);  // xSIDL

constexpr Timer::Setup kTimer1 = {sfr::TMR1, sfr::PR1, sfr::T1CON, irq::T1, 0, true};
constexpr Timer::Setup kTimer2 = {sfr::TMR2, sfr::PR2, sfr::T2CON, irq::T2, sfr::TMR3HLD};
constexpr Timer::Setup kTimer3 = {sfr::TMR3, sfr::PR3, sfr::T3CON, irq::T3};
constexpr Timer::Setup kTimer4 = {sfr::TMR4, sfr::PR4, sfr::T4CON, irq::T4, sfr::TMR5HLD};
constexpr Timer::Setup kTimer5 = {sfr::TMR5, sfr::PR5, sfr::T5CON, irq::T5};
constexpr Uart::Setup kUart1 = {1, sfr::U1MODE, irq::U1RX, irq::U1TX, PortLetter::F, 2, 3};
constexpr Uart::Setup kUart2 = {2, sfr::U2MODE, irq::U2RX, irq::U2TX, PortLetter::F, 4, 5};

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
    Pins& pins;
    ChipOptions options;
    cosim::ClockDomain clock;
    SfrSpace sfr;
    EventQueue events;
    InterruptController interrupts;
    Core core;
    Surroundings around;
    Oscillator oscillator;
    Ports ports;
    ExternalInterrupts external;
    Timer timer1, timer3, timer2, timer5, timer4;  // the upper halves of the pairs first
    Uart uart1, uart2;
    Adc12 adc;
    I2cMaster i2c;

    ChipReport report;
    std::vector<std::uint32_t> stops;
    std::optional<std::uint32_t> stopped_at;
    Time now = 0;  ///< the last `until`

    Parts(const DeviceInfo& device_info, Pins& board, const ChipOptions& chip_options)
        : device(device_info),
          pins(board),
          options(chip_options),
          clock(decode_fosc(options.fosc.value_or(0xFFFF), options.crystal_hertz).hertz /
                    device.clocks_per_cycle,
                options.ppm),
          interrupts(device, described()),
          core(device, sfr, events, interrupts),
          around{sfr, events, core.cycle_counter(), interrupts},
          oscillator(around, clock, options.crystal_hertz),
          ports(around, pins),
          external(around, ports),
          timer1(around, kTimer1),
          timer3(around, kTimer3),
          timer2(around, kTimer2, &timer3),
          timer5(around, kTimer5),
          timer4(around, kTimer4, &timer5),
          uart1(around, kUart1, clock, ports, pins),
          uart2(around, kUart2, clock, ports, pins),
          adc(around, clock, pins),
          i2c(around, clock, ports, pins) {
        wire();
    }

    SfrSpace& described() {
        sfr.describe(device.registers);
        return sfr;
    }

    void wire() {
        const struct {
            Timer& timer;
            int pin;  ///< of port C
        } clock_pins[] = {{timer1, 14}, {timer2, 1}, {timer3, 2}, {timer4, 3}, {timer5, 4}};
        for (const auto& entry : clock_pins)
            ports.watch(PortLetter::C, entry.pin, &entry.timer, [](void* owner, bool level, Cycle at) {
                static_cast<Timer*>(owner)->clock_pin(level, at);
            });
        timer3.on_match_owner = &adc;
        timer3.on_match = [](void* owner, Cycle at) {
            static_cast<Adc12*>(owner)->trigger(Adc12::Trigger::Timer3, at);
        };
        external.on_int0_owner = &adc;
        external.on_int0 = [](void* owner, Cycle at) {
            static_cast<Adc12*>(owner)->trigger(Adc12::Trigger::Int0, at);
        };
        ports.before_change_owner = &adc;
        ports.before_change = [](void* owner, Cycle until) { static_cast<Adc12*>(owner)->catch_up(until); };
        oscillator.on_rate_owner = &core;
        oscillator.on_rate = [](void* owner, double hertz) {
            static_cast<Core*>(owner)->set_cycle_rate(hertz);
            static_cast<Core*>(owner)->end_run();
        };
        core.set_cycle_rate(clock.hertz());
        core.set_reset_hook([this](ResetCause cause) { reset(cause); });
        core.set_power_hook([this](PowerMode mode) { set_power(mode); });
        core.observer().on_reset = [this](ResetCause cause, std::uint32_t pc, Cycle at) {
            if (report.resets.size() < kRecords)
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

    // Registers and modules at a reset; the core does its own and RCON.
    void reset(ResetCause cause) {
        const std::uint16_t rcon = sfr.raw(sfr::RCON);
        sfr.reset_values();
        if (cause != ResetCause::PowerOn) sfr.raw(sfr::RCON) = rcon;
        oscillator.configure(options.fosc.value_or(core.config(kFosc)));
        oscillator.reset();
        ports.reset();
        for (Timer* timer : {&timer1, &timer2, &timer3, &timer4, &timer5})
            timer->reset();
        uart1.reset();
        uart2.reset();
        adc.reset();
        i2c.reset();
        interrupts.reset();
    }

    // Sleep stops every module that needs the instruction clock, Idle those whose xSIDL bit says so.
    void set_power(PowerMode mode) {
        const auto stops = [&](std::uint16_t control) {
            return mode == PowerMode::Sleep || (mode == PowerMode::Idle && (sfr.raw(control) & kStopInIdle));
        };
        timer1.hold(stops(sfr::T1CON));
        timer2.hold(stops(sfr::T2CON));
        timer3.hold(stops(sfr::T3CON));
        timer4.hold(stops(sfr::T4CON));
        timer5.hold(stops(sfr::T5CON));
        uart1.hold(stops(sfr::U1MODE));
        uart2.hold(stops(sfr::U2MODE));
        adc.hold(stops(sfr::ADCON1) && !(mode == PowerMode::Sleep && adc.runs_in_sleep()));
    }

    Uart& uart(int unit) { return unit == 1 ? uart1 : uart2; }
    const Uart& uart(int unit) const { return unit == 1 ? uart1 : uart2; }

    /// The cycle that messages handed in now belong to: the first that starts at or after the last `until`.
    Cycle message_cycle() const { return clock.first_cycle_at(now); }

    /// Run up to `time`: the outside may change from there on.
    void arrive(Time time) {
        now = std::max(now, time);
        const Cycle reached = std::min(message_cycle(), core.cycle());
        if (reached > 0) adc.catch_up(reached - 1);
    }
};

Chip::Chip(const DeviceInfo& device, Pins& pins, const ChipOptions& options)
    : parts_(std::make_unique<Parts>(device, pins, options)) {}

Chip::~Chip() = default;

void Chip::load(const image::Image& image) {
    image::check_fits(image, image::find_device(parts_->device.name));
    for (const auto& [address, word] : image.all_words())
        parts_->core.poke_program(address, word);
}

void Chip::load_word(std::uint32_t address, std::uint32_t word) {
    const ProgramWord one[] = {{address, word}};
    parts_->core.load(one);
}

void Chip::power_on() {
    parts_->core.reset(ResetCause::PowerOn);
}

void Chip::mclr() {
    parts_->core.reset(ResetCause::Mclr);
}

void Chip::run_until(Time until) {
    Parts& parts = *parts_;
    parts.stopped_at.reset();
    // The rate may change on the way: then the cycle that starts at `until` is another one.
    for (Cycle limit = parts.clock.first_cycle_at(until);; limit = parts.clock.first_cycle_at(until)) {
        if (parts.core.run(limit) == Core::Outcome::Stopped) {
            parts.stopped_at = parts.core.pc();
            parts.arrive(std::min(until, parts.clock.time_of(parts.core.cycle())));
            return;
        }
        if (parts.clock.first_cycle_at(until) <= parts.core.cycle()) break;
    }
    parts.arrive(until);
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

void Chip::i2c_answer(int, const cosim::I2cPhase& phase) {
    parts_->i2c.answer(phase, parts_->message_cycle());
}

void Chip::i2c_slave_phase(int unit, const cosim::I2cPhase& phase) {
    if (phase.kind == cosim::I2cPhaseKind::Stop) return;
    cosim::I2cPhase answer = phase;
    answer.kind = phase.kind == cosim::I2cPhaseKind::Read ? cosim::I2cPhaseKind::Data
                                                          : cosim::I2cPhaseKind::Acknowledge;
    answer.ack = 0;
    answer.byte = 0xFF;
    parts_->pins.i2c_slave_answer(unit, answer);
}

void Chip::pins_changed(PortLetter port) {
    parts_->ports.outside_changed(port, parts_->message_cycle());
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

Time Chip::earliest_i2c(int) const {
    const Cycle cycle = parts_->i2c.earliest(std::max(parts_->core.cycle(), parts_->message_cycle()));
    return cycle == kNoCycle ? cosim::kNever : parts_->clock.time_of(cycle);
}

Time Chip::earliest_i2c_slave_answer(int) const {
    return cosim::kNever;
}

OutputCompareState Chip::output_compare(int) const {
    return {};
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

std::uint16_t Chip::peek(std::string_view register_name) const {
    const RegisterInfo* info = parts_->sfr.find(register_name);
    if (!info) throw std::out_of_range("no register " + std::string(register_name));
    parts_->ports.refresh();
    for (Timer* timer : {&parts_->timer1, &parts_->timer2, &parts_->timer3, &parts_->timer4, &parts_->timer5})
        timer->refresh();
    return parts_->sfr.raw(info->address);
}

ChipReport Chip::report() const {
    ChipReport report = parts_->report;
    report.instructions = parts_->core.instructions();
    report.cycles = parts_->core.cycle();
    return report;
}

void Chip::set_skipping(bool on) {
    parts_->core.set_skip_idle(on);
}

}  // namespace puckloop::dspic
