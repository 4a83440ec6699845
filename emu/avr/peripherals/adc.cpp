#include "emu/avr/peripherals/adc.h"

#include "emu/avr/peripherals/shared_registers.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace puckloop::avr {

namespace {

constexpr int kAdcVector = 24;
constexpr std::uint16_t kAdcl = 0x78, kAdch = 0x79;
// ADCSRA
constexpr std::uint8_t kAdsc = bit(6), kAdate = bit(5), kAdif = bit(4), kAdie = bit(3);
constexpr std::uint8_t kAdlar = bit(5);  // ADMUX
constexpr std::uint8_t kPradc = bit(0);  // PRR0
constexpr unsigned kFreeRunning = 0;     // ADTS
/// ADC clocks, in halves: sample and hold, and the end of the conversion (data sheet, "ADC Conversion Time").
constexpr Cycle kFirstSample = 27, kFirstEnd = 50, kSample = 3, kEnd = 26, kTriggeredSample = 4,
                kTriggeredEnd = 27;
constexpr double kInternalReference = 2.56;

/// MUX4:0 = 8..29 (data sheet 8272, table "Input Channel and Gain Selections").
struct Differential {
    int positive = 0, negative = 0;
    double gain = 1;
};
std::optional<Differential> differential(unsigned channel) {
    constexpr Differential kGain[] = {{0, 0, 10}, {1, 0, 10}, {0, 0, 200}, {1, 0, 200},
                                      {2, 2, 10}, {3, 2, 10}, {2, 2, 200}, {3, 2, 200}};
    constexpr unsigned kFirst = 8, kAgainst1 = 16, kAgainst2 = 24, kEnd = 30;
    if (channel < kFirst || channel >= kEnd) return std::nullopt;
    if (channel < kAgainst1) return kGain[channel - kFirst];
    if (channel < kAgainst2) return Differential{static_cast<int>(channel - kAgainst1), 1, 1};
    return Differential{static_cast<int>(channel - kAgainst2), 2, 1};
}

}  // namespace

Adc::Adc(const Surroundings& around, Pins& pins, const References& references)
    : around_(around), pins_(pins), references_(references), slot_(around.events.add(this, &due)) {
    around_.io.hook(kAdcl, this, &read_result, &write_result);
    around_.io.hook(kAdch, this, &read_result, &write_result);
    around_.io.hook_quiet(kAdcl, &look_at_result);
    around_.io.hook_quiet(kAdch, &look_at_result);
    around_.io.hook(kAdcsra, this, nullptr, &write_control);
    around_.io.hook(kAdcsrb, this, nullptr, &write_source);
    around_.io.hook(kAdmux, this, nullptr, &write_mux);
    around_.interrupts.connect(kAdcVector, this, &acknowledge);
}

void Adc::reset() {
    state_ = {};
    around_.events.cancel(slot_);
    if (source_changed) source_changed();
}

unsigned Adc::trigger_source() const {
    constexpr std::uint8_t kBoth = kAden | kAdate;
    return (control() & kBoth) == kBoth ? field(around_.io.raw(kAdcsrb), 2, 0) : kFreeRunning;
}

// A source that is chosen while its flag is set has an edge (data sheet, "Starting a Conversion").
void Adc::update_source() {
    const unsigned source = trigger_source();
    if (source == state_.source) return;
    state_.source = source;
    if (source_changed) source_changed();
    if (source != kFreeRunning && source_set && source_set(source)) trigger(source);
}

void Adc::quiet() {
    const bool powered = !(around_.io.raw(kPrr0) & kPradc);
    if ((control() & kAden) && powered && !state_.converting) start(around_.now + 1, false);
}

Cycle Adc::clocks_per_tick() const {
    const unsigned select = field(control(), 2, 0);
    return Cycle{1} << std::max(select, 1u);
}

void Adc::update_request() {
    around_.interrupts.request(kAdcVector, (control() & kAdif) && (control() & kAdie));
}
void Adc::acknowledge(void* owner, int) {
    auto& self = *static_cast<Adc*>(owner);
    assign(self.control(), kAdif, false);
    self.update_request();
}

// The prescaler runs while ADEN is set; a conversion begins with the next rising edge of its clock. A trigger
// resets it.
void Adc::start(Cycle now, bool triggered) {
    const Cycle tick = clocks_per_tick();
    if (triggered) state_.phase = now;
    const Cycle begin = now + (tick - (now - state_.phase) % tick) % tick;
    const Cycle sample = state_.first ? kFirstSample : triggered ? kTriggeredSample : kSample;
    const Cycle end = state_.first ? kFirstEnd : triggered ? kTriggeredEnd : kEnd;
    state_.begin = begin;
    state_.mux = around_.io.raw(kAdmux);
    state_.converting = true;
    state_.sampled = false;
    state_.first = false;
    state_.end = begin + end * tick / 2;
    control() |= kAdsc;
    around_.events.schedule(slot_, begin + sample * tick / 2);
}

std::uint16_t Adc::convert(Cycle now) const {
    const std::uint8_t mux = state_.mux;
    const double references[] = {references_.aref, references_.avcc, kBandgap, kInternalReference};
    const double reference = references[field(mux, 7, 6)];
    const unsigned channel = field(mux, 4, 0);
    constexpr unsigned kInputs = 8, kBandgapChannel = 0x1E;
    if (const auto pair = differential(channel)) {  // two's complement, ten bits
        const double volts = pins_.analog(pair->positive, now) - pins_.analog(pair->negative, now);
        const double code = std::clamp(volts * pair->gain / reference * 512.0, -512.0, 511.0);
        return static_cast<std::uint16_t>(static_cast<int>(std::floor(code)) & 0x3FF);
    }
    const double volts = channel < kInputs            ? pins_.analog(static_cast<int>(channel), now)
                         : channel == kBandgapChannel ? kBandgap
                                                      : 0.0;
    const double code = volts / reference * 1024.0;
    return static_cast<std::uint16_t>(std::clamp(code, 0.0, 1023.0));
}

void Adc::due(void* owner, Cycle cycle) {
    auto& self = *static_cast<Adc*>(owner);
    if (!self.state_.sampled) {
        self.state_.sampled = true;
        self.state_.held = self.convert(cycle);
        self.around_.events.schedule(self.slot_, self.state_.end);
        return;
    }
    self.finish(cycle);
}

// A result that ADCL was read of stays until ADCH is: the new one is lost.
void Adc::finish(Cycle now) {
    state_.converting = false;
    if (!state_.locked) state_.result = state_.held;
    assign(control(), kAdsc, false);
    control() |= kAdif;
    update_request();
    if ((control() & kAdate) && field(around_.io.raw(kAdcsrb), 2, 0) == kFreeRunning) start(now, false);
}

void Adc::trigger(unsigned number) {
    if (!(control() & kAden) || !(control() & kAdate) || state_.converting) return;
    if (number != kFreeRunning && number == field(around_.io.raw(kAdcsrb), 2, 0)) start(around_.now, true);
}

std::uint8_t Adc::read_result(void* owner, std::uint16_t address) {
    static_cast<Adc*>(owner)->state_.locked = address == kAdcl;
    return look_at_result(owner, address);
}
std::uint8_t Adc::look_at_result(void* owner, std::uint16_t address) {
    const auto& self = *static_cast<Adc*>(owner);
    const bool left = self.around_.io.raw(kAdmux) & kAdlar;
    const unsigned value = left ? self.state_.result << 6u : self.state_.result;
    return static_cast<std::uint8_t>(address == kAdcl ? value : value >> 8);
}
void Adc::write_result(void*, std::uint16_t, std::uint8_t, std::uint8_t) {}  // read only

// ADIF is cleared by writing a one, ADSC by nothing but the end of the conversion.
void Adc::write_control(void* owner, std::uint16_t, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Adc*>(owner);
    const std::uint8_t old = self.control();
    std::uint8_t now = merged(old, value, mask & static_cast<std::uint8_t>(~(kAdif | kAdsc)));
    if (value & mask & kAdif) assign(now, kAdif, false);
    self.control() = now;
    const bool powered = !(self.around_.io.raw(kPrr0) & kPradc);
    if (!(now & kAden) || !powered) {
        self.state_.converting = false;
        self.state_.first = true;
        assign(self.control(), kAdsc, false);
        self.around_.events.cancel(self.slot_);
    } else {
        if (!(old & kAden)) self.state_.phase = self.around_.now;
        if ((value & mask & kAdsc) && !self.state_.converting) self.start(self.around_.now + 1, false);
    }
    self.update_request();
    self.update_source();
    if (((old ^ self.control()) & kAden) && self.input_changed) self.input_changed();
}

// Channel and reference follow the register until the conversion begins, with the ADC's clock.
void Adc::write_mux(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Adc*>(owner);
    self.around_.io.store(address, value, mask);
    if (self.state_.converting && self.around_.now < self.state_.begin)
        self.state_.mux = self.around_.io.raw(address);
    if (self.input_changed) self.input_changed();
}

void Adc::write_source(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Adc*>(owner);
    self.around_.io.store(address, value, mask);
    self.update_source();
    if (self.input_changed) self.input_changed();
}

}  // namespace puckloop::avr
