#include "emu/dspic/peripherals/adc_33f.h"

#include "emu/dspic/devices/register_bits.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace puckloop::dspic {

namespace {

constexpr RegisterBits kADxCON1{"AD?CON1"};
constexpr RegisterBits kADxCON2{"AD?CON2"};
constexpr RegisterBits kADxCON3{"AD?CON3"};
constexpr RegisterBits kADxCHS0{"AD1CHS0"};  // AD2CHS0 names the uppermost bits apart
constexpr RegisterBits kADxCHS123{"AD?CHS123"};

constexpr Cycle kTads12 = 14;
constexpr Cycle kTads10 = 12;
constexpr double kRcTadSeconds = 250e-9;
constexpr int kVrefPlusInput = 0;   // VREF+ shares its pin with AN0 ...
constexpr int kVrefMinusInput = 1;  // ... and VREF- with AN1

}  // namespace

Adc33F::Adc33F(const Surroundings& around, const Setup& setup, const cosim::ClockDomain& clock, Ports& ports,
               Pins& pins)
    : around_(around),
      setup_(setup),
      clock_(clock),
      ports_(ports),
      pins_(pins),
      slot_(around.events.add(this, due)) {
    around_.sfr.claim(setup_.buf0);
    around_.sfr.hook(setup_.con1, this, nullptr, write_con1);
    around_.sfr.hook(static_cast<std::uint16_t>(setup_.con1 + 2), this, nullptr, write_con2);
    around_.sfr.hook(static_cast<std::uint16_t>(setup_.con1 + 4), this, nullptr, write_con3);
    for (const int offset : {6, 8})
        around_.sfr.claim(static_cast<std::uint16_t>(setup_.con1 + offset));
    for (const std::uint16_t address :
         {setup_.pcfg_high, setup_.pcfg_low, setup_.css_high, setup_.css_low, setup_.con4})
        if (address) around_.sfr.claim(address);
}

void Adc33F::reset() {
    const bool held = state_.held;
    state_ = {};
    state_.held = held;
    around_.events.cancel(slot_);
}

Adc33F::Trigger Adc33F::source() const {
    return static_cast<Trigger>(kADxCON1["SSRC"].of(con(1)));
}
bool Adc33F::twelve_bits() const {
    return con(1) & kADxCON1["AD12B"];
}

// CHPS: CH0; CH0 and CH1; all four. 12 bits: always CH0 alone.
int Adc33F::channels() const {
    if (twelve_bits()) return 1;
    const unsigned chps = kADxCON2["CHPS"].of(con(2));
    return chps == 0 ? 1 : chps == 1 ? 2 : kChannels;
}

// TAD = TCY (ADCS + 1)
Cycle Adc33F::tad() const {
    if (con(3) & kADxCON3["ADRC"])
        return std::max<Cycle>(1, static_cast<Cycle>(std::llround(kRcTadSeconds * clock_.hertz())));
    return kADxCON3["ADCS"].of(con(3)) + 1u;
}

Cycle Adc33F::conversion_cycles() const {
    return tad() * (twelve_bits() ? kTads12 : kTads10);
}

// The next input to scan: from the last one upward, all over again after the highest.
std::uint8_t Adc33F::scan() {
    std::uint64_t selected = around_.sfr.raw(setup_.css_low);
    if (setup_.css_high) selected |= static_cast<std::uint64_t>(around_.sfr.raw(setup_.css_high)) << 16;
    if (selected == 0) return 0;
    std::uint64_t rest = selected & ~((std::uint64_t{1} << state_.scanned) - 1u);
    if (rest == 0) rest = selected;
    const int input = std::countr_zero(rest);
    state_.scanned = static_cast<std::uint8_t>(input + 1);
    return static_cast<std::uint8_t>(input);
}

void Adc33F::begin_sampling(Cycle at) {
    if (state_.mux_b)
        state_.input = static_cast<std::uint8_t>(kADxCHS0["CH0SB"].of(chs0()));
    else if (con(2) & kADxCON2["CSCNA"])
        state_.input = scan();
    else
        state_.input = static_cast<std::uint8_t>(kADxCHS0["CH0SA"].of(chs0()));
    state_.phase = Phase::Sampling;
    con(1) |= kADxCON1["SAMP"];
    if (source() == Trigger::Counter)
        around_.events.schedule(slot_, at + kADxCON3["SAMC"].of(con(3)) * tad());
    else
        around_.events.cancel(slot_);
}

void Adc33F::end_sampling(Cycle at) {
    const int taken = con(1) & kADxCON1["SIMSAM"] ? channels() : 1;
    for (int channel = 0; channel < taken; ++channel)
        state_.results[static_cast<std::size_t>(channel)] = convert(channel, at);
    state_.phase = Phase::Converting;
    state_.channel = 0;
    con(1) = static_cast<std::uint16_t>(con(1) & ~(kADxCON1["SAMP"] | kADxCON1["DONE"]));
    around_.events.schedule(slot_, at + conversion_cycles());
}

void Adc33F::end_conversion(Cycle at) {
    around_.sfr.raw(setup_.buf0) = state_.results[state_.channel];
    ++state_.channel;
    if (state_.channel < channels()) {
        around_.interrupts.request(setup_.irq, at);
        if (!(con(1) & kADxCON1["SIMSAM"])) state_.results[state_.channel] = convert(state_.channel, at);
        around_.events.schedule(slot_, at + conversion_cycles());
        return;
    }
    group_done(at);
}

void Adc33F::group_done(Cycle at) {
    con(1) |= kADxCON1["DONE"];
    state_.phase = Phase::Idle;
    if (con(2) & kADxCON2["ALTS"]) state_.mux_b = !state_.mux_b;
    if (state_.groups >= kADxCON2["SMPI"].of(con(2))) {
        state_.groups = 0;
        state_.scanned = 0;
        around_.interrupts.raise(setup_.irq, at);
    } else {
        ++state_.groups;
        around_.interrupts.request(setup_.irq, at);
    }
    if (con(1) & kADxCON1["ASAM"]) begin_sampling(at);
}

double Adc33F::input(int number, Cycle at) const {
    if (number >= setup_.inputs) return 0.0;  // no pin: VREFL
    if (ports_.digital(number)) return 0.0;   // cut off from the converter
    if (const auto level = ports_.driven_level(number)) return *level ? 1.0 : 0.0;
    return pins_.analog(number, at);
}

// CH123SA/SB: CH1..CH3 take AN0..AN2 or AN3..AN5.
double Adc33F::positive(int channel, Cycle at) const {
    if (channel == 0) return input(state_.input, at);
    const bool upper = chs123() & (state_.mux_b ? kADxCHS123["CH123SB"] : kADxCHS123["CH123SA"]);
    return input(channel - 1 + (upper ? 3 : 0), at);
}

// CH0NA/NB: VREF- or AN1. CH123NA/NB: 0x VREF-, 10 AN6..AN8, 11 AN9..AN11.
double Adc33F::negative(int channel, Cycle at) const {
    if (channel == 0)
        return chs0() & (state_.mux_b ? kADxCHS0["CH0NB"] : kADxCHS0["CH0NA"]) ? input(kVrefMinusInput, at)
                                                                               : 0.0;
    const unsigned select = (state_.mux_b ? kADxCHS123["CH123NB"] : kADxCHS123["CH123NA"]).of(chs123());
    if (select < 2) return 0.0;
    return input((select == 2 ? 6 : 9) + channel - 1, at);
}

std::uint16_t Adc33F::convert(int channel, Cycle at) const {
    double value = positive(channel, at) - negative(channel, at);
    const unsigned vcfg = kADxCON2["VCFG"].of(con(2));
    if (vcfg != 0 && vcfg < 4) {
        const double high = vcfg & 1 ? pins_.analog(kVrefPlusInput, at) : 1.0;
        const double low = vcfg & 2 ? pins_.analog(kVrefMinusInput, at) : 0.0;
        value = high > low ? (value - low) / (high - low) : 0.0;
    }
    const int bits = twelve_bits() ? 12 : 10;
    const unsigned span = 1u << bits;
    auto counts = static_cast<unsigned>(std::clamp(std::floor(value * span), 0.0, span - 1.0));
    // FORM: integer, signed integer, fractional, signed fractional.
    const unsigned form = kADxCON1["FORM"].of(con(1));
    if (form & 1) counts -= span / 2;
    return static_cast<std::uint16_t>(form & 2 ? counts << (16 - bits) : counts);
}

void Adc33F::due(void* owner, Cycle due) {
    Adc33F& self = *static_cast<Adc33F*>(owner);
    if (self.state_.phase == Phase::Sampling)
        self.end_sampling(due);
    else if (self.state_.phase == Phase::Converting)
        self.end_conversion(due);
}

void Adc33F::trigger(Trigger source, Cycle at) {
    if (state_.phase == Phase::Sampling && this->source() == source) end_sampling(at);
}

bool Adc33F::runs_in_sleep() const {
    return con(3) & kADxCON3["ADRC"];
}

void Adc33F::hold(bool on) {
    if (state_.held == on) return;
    state_.held = on;
    if (state_.phase == Phase::Off) return;
    if (on) {
        state_.phase = Phase::Idle;
        around_.events.cancel(slot_);
        con(1) &= static_cast<std::uint16_t>(~kADxCON1["SAMP"]);
    } else if (con(1) & kADxCON1["ASAM"]) {
        begin_sampling(around_.now);
    }
}

void Adc33F::write_con1(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Adc33F& self = *static_cast<Adc33F*>(owner);
    const Cycle at = self.around_.now + 1;
    std::uint16_t& con1 = self.con(1);
    const std::uint16_t old = con1;
    self.around_.sfr.store(address, value, mask);
    if (!(old & kADxCON1["DONE"]))
        con1 &= static_cast<std::uint16_t>(~kADxCON1["DONE"]);  // it can be cleared, not set
    if (!(con1 & kADxCON1["ADON"])) {
        self.reset();
        con1 &= static_cast<std::uint16_t>(~kADxCON1["SAMP"]);
        return;
    }
    if (self.state_.phase == Phase::Off) self.state_.phase = Phase::Idle;
    switch (self.state_.phase) {
    case Phase::Idle:
        if (con1 & (kADxCON1["ASAM"] | kADxCON1["SAMP"])) self.begin_sampling(at);
        break;
    case Phase::Sampling:
        if (!(con1 & kADxCON1["SAMP"]) && self.source() == Trigger::Software)
            self.end_sampling(at);
        else
            con1 |= kADxCON1["SAMP"];
        break;
    default:
        con1 &= static_cast<std::uint16_t>(~kADxCON1["SAMP"]);
        break;
    }
}

void Adc33F::write_con2(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    static_cast<Adc33F*>(owner)->around_.sfr.store(address, value,
                                                   static_cast<std::uint16_t>(mask & ~kADxCON2["BUFS"]));
}

void Adc33F::write_con3(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    static_cast<Adc33F*>(owner)->around_.sfr.store(address, value, mask);
}

}  // namespace puckloop::dspic
