#include "emu/dspic/peripherals/adc12.h"

#include "emu/dspic/devices/dspic30f6014a_irq.h"
#include "emu/dspic/devices/dspic30f6014a_sfr.h"
#include "emu/dspic/devices/register_bits.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace puckloop::dspic {

namespace {

constexpr RegisterBits kADCON1{"ADCON1"};
constexpr RegisterBits kADCON2{"ADCON2"};
constexpr RegisterBits kADCON3{"ADCON3"};
constexpr RegisterBits kADCHS{"ADCHS"};

constexpr int kConversionTads = 14;
constexpr double kRcTadSeconds = 900e-9;
constexpr int kInputs = 16;
constexpr int kHalfBuffer = 8;
constexpr unsigned kFullScale = 4096;
constexpr int kVrefPlusPin = 0;   // AN0
constexpr int kVrefMinusPin = 1;  // AN1

/// An input, as a fraction of the reference span, in counts; what is below a whole one does not count.
unsigned counts_of(double value) {
    return static_cast<unsigned>(std::clamp(value * kFullScale, 0.0, kFullScale - 1.0));
}

}  // namespace

Adc12::Adc12(const Surroundings& around, const cosim::ClockDomain& clock, Pins& pins)
    : around_(around), clock_(clock), pins_(pins), slot_(around.events.add(this, due)) {
    for (int i = 0; i < kInputs; ++i) {
        const auto buffer = static_cast<std::uint16_t>(sfr::ADCBUF0 + 2 * i);
        around_.sfr.hook(buffer, this, read_register, nullptr);
        around_.sfr.set_plain_kind(buffer, SfrSpace::Plain::kConverter);
    }
    around_.sfr.hook(sfr::ADCON1, this, read_register, write_adcon1);
    around_.sfr.hook(sfr::ADCON2, this, read_register, write_register);
    for (const std::uint16_t address : {sfr::ADCON3, sfr::ADCHS, sfr::ADPCFG, sfr::ADCSSL})
        around_.sfr.hook(address, this, nullptr, write_register);
}

void Adc12::reset() {
    state_ = {};
    group_.epoch = 0;
    around_.events.cancel(slot_);
    forget_quiet();
}

Adc12::Trigger Adc12::source() const {
    return static_cast<Trigger>(kADCON1["SSRC"].of(around_.sfr.raw(sfr::ADCON1)));
}

// TAD = TCY (ADCS + 1) / 2, in half cycles.
Adc12::HalfCycle Adc12::tad() const {
    const std::uint16_t adcon3 = around_.sfr.raw(sfr::ADCON3);
    if (adcon3 & kADCON3["ADRC"])
        return std::max<HalfCycle>(
            1, static_cast<HalfCycle>(std::llround(kRcTadSeconds * 2.0 * clock_.hertz())));
    return kADCON3["ADCS"].of(adcon3) + 1u;
}

// The next input to scan: ADCSSL from the last one upward, all over again after the highest.
std::uint8_t Adc12::scan() {
    const unsigned selected = around_.sfr.raw(sfr::ADCSSL);
    if (selected == 0) return 0;
    unsigned rest = selected & ~((1u << state_.scanned) - 1u);
    if (rest == 0) rest = selected;
    const int channel = std::countr_zero(rest);
    state_.scanned = static_cast<std::uint8_t>(channel + 1);
    return static_cast<std::uint8_t>(channel);
}

void Adc12::begin_sampling(HalfCycle at) {
    const std::uint16_t adchs = around_.sfr.raw(sfr::ADCHS);
    if (state_.mux_b)
        state_.channel = static_cast<std::uint8_t>(kADCHS["CH0SB"].of(adchs));
    else if (around_.sfr.raw(sfr::ADCON2) & kADCON2["CSCNA"])
        state_.channel = scan();
    else
        state_.channel = static_cast<std::uint8_t>(kADCHS["CH0SA"].of(adchs));
    state_.phase = Phase::Sampling;
    state_.timed = source() == Trigger::Counter;
    state_.phase_end = at + kADCON3["SAMC"].of(around_.sfr.raw(sfr::ADCON3)) * tad();
    around_.sfr.raw(sfr::ADCON1) |= kADCON1["SAMP"];
}

void Adc12::end_sampling(HalfCycle at) {
    state_.result = formatted(convert(at / 2), kADCON1["FORM"].of(around_.sfr.raw(sfr::ADCON1)));
    state_.phase = Phase::Converting;
    state_.timed = true;
    state_.phase_end = at + kConversionTads * tad();
    std::uint16_t& adcon1 = around_.sfr.raw(sfr::ADCON1);
    adcon1 = static_cast<std::uint16_t>(adcon1 & ~(kADCON1["SAMP"] | kADCON1["DONE"]));
}

// ADIF comes with this conversion.
void Adc12::end_group(HalfCycle at) {
    std::uint16_t& adcon2 = around_.sfr.raw(sfr::ADCON2);
    state_.done = 0;
    state_.scanned = 0;
    if (adcon2 & kADCON2["BUFM"]) adcon2 ^= kADCON2["BUFS"];
    state_.next = adcon2 & kADCON2["BUFM"] && adcon2 & kADCON2["BUFS"] ? kHalfBuffer : 0;
    around_.interrupts.raise(irq::ADC, (at + 1) / 2);
}

void Adc12::end_conversion(HalfCycle at) {
    std::uint16_t& adcon1 = around_.sfr.raw(sfr::ADCON1);
    std::uint16_t& adcon2 = around_.sfr.raw(sfr::ADCON2);
    around_.sfr.raw(static_cast<std::uint16_t>(sfr::ADCBUF0 + 2 * state_.next)) = state_.result;
    adcon1 |= kADCON1["DONE"];
    if (adcon2 & kADCON2["ALTS"]) state_.mux_b = !state_.mux_b;
    if (state_.done >= kADCON2["SMPI"].of(adcon2)) {
        end_group(at);
    } else {
        ++state_.done;
        state_.next = static_cast<std::uint8_t>((state_.next + 1) % kInputs);
    }
    state_.phase = Phase::Idle;
    if (adcon1 & kADCON1["ASAM"]) begin_sampling(at);
}

double Adc12::input(int channel, Cycle at) const {
    const std::uint16_t pin = bit(channel);
    if (around_.sfr.raw(sfr::ADPCFG) & pin) return 0.0;  // a digital pin is cut off from the converter
    if (!(around_.sfr.raw(sfr::TRISB) & pin)) return around_.sfr.raw(sfr::LATB) & pin ? 1.0 : 0.0;
    return pins_.analog(channel, at);
}

std::uint16_t Adc12::convert(Cycle at) const {
    double value = input(state_.channel, at);
    const std::uint16_t adchs = around_.sfr.raw(sfr::ADCHS);
    if (adchs & (state_.mux_b ? kADCHS["CH0NB"] : kADCHS["CH0NA"])) value -= input(kVrefMinusPin, at);
    const unsigned vcfg = kADCON2["VCFG"].of(around_.sfr.raw(sfr::ADCON2));
    if (vcfg != 0 && vcfg < 4) {
        const double high = vcfg & 1 ? pins_.analog(kVrefPlusPin, at) : 1.0;
        const double low = vcfg & 2 ? pins_.analog(kVrefMinusPin, at) : 0.0;
        value = high > low ? (value - low) / (high - low) : 0.0;
    }
    return static_cast<std::uint16_t>(counts_of(value));
}

// FORM: integer, signed integer, fractional, signed fractional.
std::uint16_t Adc12::formatted(unsigned counts, unsigned form) const {
    if (form & 1) counts -= kFullScale / 2;
    return static_cast<std::uint16_t>(form & 2 ? counts << 4 : counts);
}

void Adc12::switch_off() {
    state_ = {};
    around_.sfr.raw(sfr::ADCON1) &= static_cast<std::uint16_t>(~kADCON1["SAMP"]);
    around_.sfr.raw(sfr::ADCON2) &= static_cast<std::uint16_t>(~kADCON2["BUFS"]);
}

// One conversion follows another, each of an input of MUX A against AVSS, scaled by the supply.
bool Adc12::goes_on_by_itself() const {
    const std::uint16_t adcon2 = around_.sfr.raw(sfr::ADCON2);
    const unsigned vcfg = kADCON2["VCFG"].of(adcon2);
    return (around_.sfr.raw(sfr::ADCON1) & kADCON1["ASAM"]) && source() == Trigger::Counter &&
           !(adcon2 & kADCON2["ALTS"]) && !state_.mux_b && (vcfg == 0 || vcfg >= 4) &&
           !(around_.sfr.raw(sfr::ADCHS) & kADCHS["CH0NA"]);
}

/// The group that begins with the present sampling gives what the last one gave.
bool Adc12::repeats() const {
    return group_.epoch != 0 && group_.channel == state_.channel && group_.scanned == state_.scanned &&
           group_.tris == around_.sfr.raw(sfr::TRISB) && group_.lat == around_.sfr.raw(sfr::LATB) &&
           pins_.analog_epoch(state_.phase_end / 2) == group_.epoch;
}

// end_sampling() and end_conversion() in turn up to `until`, with what the registers say looked up once: no
// one writes them meanwhile.
void Adc12::run_automatic(HalfCycle until) {
    const std::uint16_t adchs = around_.sfr.raw(sfr::ADCHS), adcon3 = around_.sfr.raw(sfr::ADCON3);
    std::uint16_t& adcon1 = around_.sfr.raw(sfr::ADCON1);
    const std::uint16_t adcon2 = around_.sfr.raw(sfr::ADCON2);
    std::uint16_t* const buffers = &around_.sfr.raw(sfr::ADCBUF0);
    const auto analog =
        static_cast<std::uint16_t>(~around_.sfr.raw(sfr::ADPCFG) & around_.sfr.raw(sfr::TRISB));
    const unsigned form = kADCON1["FORM"].of(adcon1), last = kADCON2["SMPI"].of(adcon2);
    const bool scans = adcon2 & kADCON2["CSCNA"];
    const HalfCycle conversion = kConversionTads * tad(), sampling = kADCON3["SAMC"].of(adcon3) * tad();
    const bool whole = !(adcon2 & kADCON2["BUFM"]);  // every group fills the buffers from the first on
    const HalfCycle rest = conversion + last * (sampling + conversion);  // from its first sample to its end
    while (state_.phase_end <= until) {
        if (whole && state_.phase == Phase::Sampling && state_.done == 0 && state_.next == 0) {
            const HalfCycle end = state_.phase_end + rest;
            if (end <= until && repeats()) {
                const std::uint8_t scanned = state_.scanned;
                std::copy_n(group_.results.begin(), last + 1, buffers);
                adcon1 |= kADCON1["DONE"] | kADCON1["SAMP"];
                end_group(end);
                state_.scanned = scanned;
                state_.result = group_.results[last];
                state_.phase_end = end + sampling;
                continue;
            }
            group_ = {.epoch = pins_.analog_epoch(state_.phase_end / 2),
                      .channel = state_.channel,
                      .scanned = state_.scanned,
                      .tris = around_.sfr.raw(sfr::TRISB),
                      .lat = around_.sfr.raw(sfr::LATB)};
        }
        if (state_.phase == Phase::Sampling) {
            const int channel = state_.channel;
            const Cycle at = state_.phase_end / 2;
            state_.result = formatted(
                counts_of(analog >> channel & 1 ? pins_.analog(channel, at) : input(channel, at)), form);
            state_.phase = Phase::Converting;
            state_.phase_end += conversion;
            adcon1 = static_cast<std::uint16_t>(adcon1 & ~(kADCON1["SAMP"] | kADCON1["DONE"]));
            continue;
        }
        buffers[state_.next] = state_.result;
        adcon1 |= kADCON1["DONE"];
        if (state_.done >= last) {
            end_group(state_.phase_end);
            if (group_.epoch != 0 && pins_.analog_epoch(state_.phase_end / 2) == group_.epoch)
                std::copy_n(buffers, last + 1, group_.results.begin());
            else
                group_.epoch = 0;
        } else {
            ++state_.done;
            state_.next = static_cast<std::uint8_t>((state_.next + 1) % kInputs);
        }
        state_.channel = scans ? scan() : static_cast<std::uint8_t>(kADCHS["CH0SA"].of(adchs));
        state_.phase = Phase::Sampling;
        state_.phase_end += sampling;
        adcon1 |= kADCON1["SAMP"];
    }
}

void Adc12::catch_up(Cycle now) {
    if (!state_.timed || state_.phase_end > 2 * now) return;
    if (goes_on_by_itself()) return run_automatic(2 * now);
    while (state_.timed && state_.phase_end <= 2 * now) {
        state_.timed = false;
        if (state_.phase == Phase::Sampling)
            end_sampling(state_.phase_end);
        else
            end_conversion(state_.phase_end);
    }
}

// Until the conversion under way ends, and while none is, the buffers stay as they are.
void Adc12::note_quiet() {
    HalfCycle end = state_.phase_end;
    const bool rc = around_.sfr.raw(sfr::ADCON3) & kADCON3["ADRC"];  // then TAD may change meanwhile
    if (state_.phase == Phase::Sampling && !rc) end += kConversionTads * tad();
    around_.sfr.plain().until[SfrSpace::Plain::kConverter] = state_.timed ? (end + 1) / 2 : kNoCycle;
}

// Automatic groups need one event, at the interrupt: all before is made up for by catch_up(), which
// everything calls that could see the difference.
void Adc12::plan() {
    note_quiet();
    if (!state_.timed) {
        around_.events.cancel(slot_);
        return;
    }
    HalfCycle when = state_.phase_end;
    if ((around_.sfr.raw(sfr::ADCON1) & kADCON1["ASAM"]) && source() == Trigger::Counter) {
        const HalfCycle conversion = kConversionTads * tad();
        const HalfCycle sampling = kADCON3["SAMC"].of(around_.sfr.raw(sfr::ADCON3)) * tad();
        const unsigned last = kADCON2["SMPI"].of(around_.sfr.raw(sfr::ADCON2));
        if (state_.phase == Phase::Sampling) when += conversion;
        if (last > state_.done) when += (last - state_.done) * (sampling + conversion);
    }
    around_.events.schedule(slot_, (when + 1) / 2);
}

void Adc12::due(void* owner, Cycle due) {
    Adc12& self = *static_cast<Adc12*>(owner);
    self.catch_up(due);
    self.plan();
}

void Adc12::trigger(Trigger source, Cycle at) {
    catch_up(at);
    if (state_.phase != Phase::Sampling || this->source() != source) return;
    end_sampling(2 * at);
    plan();
}

bool Adc12::runs_in_sleep() const {
    return around_.sfr.raw(sfr::ADCON3) & kADCON3["ADRC"];
}

void Adc12::hold(bool on) {
    if (state_.held == on) return;
    state_.held = on;
    group_.epoch = 0;
    if (state_.phase == Phase::Off) return;
    std::uint16_t& adcon1 = around_.sfr.raw(sfr::ADCON1);
    if (on) {
        catch_up(around_.now);
        state_.phase = Phase::Idle;
        state_.timed = false;
        adcon1 &= static_cast<std::uint16_t>(~kADCON1["SAMP"]);
    } else if (adcon1 & kADCON1["ASAM"]) {
        begin_sampling(2 * around_.now);
    }
    plan();
}

std::uint16_t Adc12::read_register(void* owner, std::uint16_t address) {
    Adc12& self = *static_cast<Adc12*>(owner);
    self.catch_up(self.around_.now);
    self.note_quiet();
    return self.around_.sfr.raw(address);
}

void Adc12::write_register(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Adc12& self = *static_cast<Adc12*>(owner);
    self.catch_up(self.around_.now);
    if (address == sfr::ADCON2) mask &= static_cast<std::uint16_t>(~kADCON2["BUFS"]);
    self.around_.sfr.store(address, value, mask);
    self.group_.epoch = 0;
    self.plan();
}

void Adc12::write_adcon1(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Adc12& self = *static_cast<Adc12*>(owner);
    self.catch_up(self.around_.now);
    const HalfCycle at = 2 * (self.around_.now + 1);
    const std::uint16_t old = self.around_.sfr.raw(address);
    self.around_.sfr.store(address, value, mask);
    self.group_.epoch = 0;
    std::uint16_t& adcon1 = self.around_.sfr.raw(address);
    if (!(adcon1 & kADCON1["ADON"])) {
        self.switch_off();
    } else {
        if (self.state_.phase == Phase::Off) self.state_.phase = Phase::Idle;
        const bool asked = adcon1 & (kADCON1["ASAM"] | kADCON1["SAMP"]);
        if (self.state_.phase == Phase::Idle && asked) {
            self.begin_sampling(at);
        } else if (self.state_.phase == Phase::Sampling) {
            if (!(adcon1 & kADCON1["SAMP"]) && self.source() == Trigger::Software)
                self.end_sampling(at);
            else
                adcon1 |= kADCON1["SAMP"];
        } else if (self.state_.phase == Phase::Converting) {
            adcon1 &= static_cast<std::uint16_t>(~kADCON1["SAMP"]);
        }
    }
    // DONE can be cleared, not set.
    if (!(old & kADCON1["DONE"])) adcon1 &= static_cast<std::uint16_t>(~kADCON1["DONE"]);
    self.plan();
}

}  // namespace puckloop::dspic
