#include "emu/dspic/peripherals/timing/oscillator_33f.h"

#include "emu/dspic/devices/dspic33fj256gp710_sfr.h"
#include "emu/dspic/devices/register_bits.h"

#include <cmath>

namespace puckloop::dspic {

namespace {

constexpr double kFrcHertz = 7'370'000.0;
constexpr double kSoscHertz = 32'768.0;
constexpr double kLprcHertz = 32'768.0;
constexpr int kClocksPerCycle = 2;

// COSC, NOSC, FNOSC
enum Source : std::uint8_t {
    kFrc = 0,
    kFrcPll = 1,
    kPrimary = 2,
    kPrimaryPll = 3,
    kSosc = 4,
    kLprc = 5,
    kFrcBy16 = 6,
    kFrcDivided = 7
};

constexpr RegisterBits kOSCCON{"OSCCON"};
constexpr RegisterBits kCLKDIV{"CLKDIV"};
constexpr RegisterBits kPLLFBD{"PLLFBD"};
constexpr RegisterBits kOSCTUN{"OSCTUN"};
constexpr unsigned kTunSign = 0x20;   // two's complement of six bits
constexpr double kTunStep = 0.00375;  // +11.625 % at 31, -12 % at -32
constexpr std::uint16_t kHighWritable = kOSCCON["NOSC"];
constexpr std::uint16_t kLowWritable = kOSCCON["CLKLOCK"] | kOSCCON["LPOSCEN"] | kOSCCON["OSWEN"];
// FOSC
constexpr std::uint16_t kSwitchingOff = bit(7);  // FCKSM1
constexpr std::uint16_t kMonitorOff = bit(6);    // FCKSM0
constexpr unsigned kPrimaryDisabled = 3;         // POSCMD

constexpr double kFrcDivider[] = {1, 2, 4, 8, 16, 32, 64, 256};  // FRCDIV
constexpr double kPllPost[] = {2, 4, 4, 8};                      // PLLPOST

constexpr double kSwitchCycles = 10.0;
constexpr double kLockSeconds = 1e-3;

bool is_pll(std::uint8_t source) {
    return source == kFrcPll || source == kPrimaryPll;
}

}  // namespace

Oscillator33F::Oscillator33F(const Surroundings& around, cosim::ClockDomain& clock, double crystal_hertz)
    : around_(around),
      clock_(clock),
      crystal_hertz_(crystal_hertz),
      slot_(around.events.add(this, switch_due)) {
    around_.sfr.hook(sfr33::OSCCON, this, nullptr, write_osccon);
    around_.sfr.hook(sfr33::CLKDIV, this, nullptr, write_divider);
    around_.sfr.hook(sfr33::PLLFBD, this, nullptr, write_divider);
    around_.sfr.hook(sfr33::OSCTUN, this, nullptr, write_divider);
}

double Oscillator33F::start_hertz() {
    return kFrcHertz / kClocksPerCycle;
}

void Oscillator33F::reset(bool power_on) {
    state_ = {};
    around_.events.cancel(slot_);
    if (power_on) running_ = static_cast<std::uint8_t>(field(words_.foscsel, 2, 0));
    std::uint16_t& osccon = around_.sfr.raw(sfr33::OSCCON);
    osccon = static_cast<std::uint16_t>(running_ << 8);
    select(running_, around_.now);
    if (on_doze) on_doze(on_rate_owner);
}

Cycle Oscillator33F::cpu_cycle() const {
    const std::uint16_t clkdiv = around_.sfr.raw(sfr33::CLKDIV);
    return clkdiv & kCLKDIV["DOZEN"] ? Cycle{1} << kCLKDIV["DOZE"].of(clkdiv) : 1;
}

double Oscillator33F::pll(double input) const {
    const std::uint16_t clkdiv = around_.sfr.raw(sfr33::CLKDIV);
    const double multiplier = kPLLFBD["PLLDIV"].of(around_.sfr.raw(sfr33::PLLFBD)) + 2.0;
    return input * multiplier /
           ((kCLKDIV["PLLPRE"].of(clkdiv) + 2.0) * kPllPost[kCLKDIV["PLLPOST"].of(clkdiv)]);
}

double Oscillator33F::frc_hertz() const {
    const unsigned tun = kOSCTUN["TUN"].of(around_.sfr.raw(sfr33::OSCTUN));
    const int steps = static_cast<int>(tun ^ kTunSign) - static_cast<int>(kTunSign);
    return kFrcHertz * (1.0 + kTunStep * steps);
}

double Oscillator33F::source_hertz(std::uint8_t source) const {
    const double frc = frc_hertz();
    const double divided = frc / kFrcDivider[kCLKDIV["FRCDIV"].of(around_.sfr.raw(sfr33::CLKDIV))];
    switch (source) {
    case kFrcPll:
        return pll(divided);
    case kPrimary:
        return crystal_hertz_;
    case kPrimaryPll:
        return pll(crystal_hertz_);
    case kSosc:
        return kSoscHertz;
    case kLprc:
        return kLprcHertz;
    case kFrcBy16:
        return frc / 16.0;
    case kFrcDivided:
        return divided;
    default:
        return frc;
    }
}

// Runs on `source` from cycle `at` on.
void Oscillator33F::select(std::uint8_t source, Cycle at) {
    running_ = source;
    std::uint16_t& osccon = around_.sfr.raw(sfr33::OSCCON);
    osccon = static_cast<std::uint16_t>((osccon & ~0x7000u) | static_cast<unsigned>(source) << 12);
    assign(osccon, kOSCCON["LOCK"], is_pll(source));
    change_rate(clock_, at, source_hertz(source) / kClocksPerCycle);
}

void Oscillator33F::begin_switch(std::uint8_t present, std::uint8_t wanted) {
    std::uint16_t& osccon = around_.sfr.raw(sfr33::OSCCON);
    const bool primary = wanted == kPrimary || wanted == kPrimaryPll;
    if (is_pll(present) && is_pll(wanted)) {
        assign(osccon, kOSCCON["OSWEN"], false);
        return;
    }
    osccon = static_cast<std::uint16_t>(osccon & ~(kOSCCON["LOCK"] | kOSCCON["CF"]));
    // Without an oscillator to switch to, the part waits for it for ever.
    if (primary && (crystal_dead_ || field(words_.fosc, 1, 0) == kPrimaryDisabled)) return;
    double seconds = kSwitchCycles * kClocksPerCycle / source_hertz(wanted);
    if (primary) seconds += kStartupPeriods / crystal_hertz_;
    if (is_pll(wanted)) seconds += kLockSeconds;
    const auto wait = static_cast<Cycle>(std::llround(seconds * clock_.hertz()));
    around_.events.schedule(slot_, around_.now + 1 + wait);
}

bool Oscillator33F::crystal_stopped(Cycle at) {
    crystal_dead_ = true;
    if (running_ != kPrimary && running_ != kPrimaryPll) return true;
    if (words_.fosc & (kSwitchingOff | kMonitorOff)) return false;
    around_.events.cancel(slot_);
    std::uint16_t& osccon = around_.sfr.raw(sfr33::OSCCON);
    assign(osccon, kOSCCON["OSWEN"], false);
    osccon |= kOSCCON["CF"];
    select(kFrc, at);
    around_.interrupts.raise_trap(Trap::OscillatorFail, at);
    return true;
}

double Oscillator33F::wake_seconds() const {
    constexpr unsigned kExternalClock = 0;  // POSCMD: nothing has to start
    double seconds = kPowerOnSeconds;
    const bool primary = running_ == kPrimary || running_ == kPrimaryPll;
    if (primary && field(words_.fosc, 1, 0) != kExternalClock) seconds += kStartupPeriods / crystal_hertz_;
    if (is_pll(running_)) seconds += kLockSeconds;
    if (!(words_.fosc & (kSwitchingOff | kMonitorOff))) seconds += kMonitorSeconds;
    return seconds;
}

void Oscillator33F::write_osccon(void* owner, std::uint16_t address, std::uint16_t value,
                                 std::uint16_t mask) {
    Oscillator33F& self = *static_cast<Oscillator33F*>(owner);
    std::uint16_t& osccon = self.around_.sfr.raw(address);
    const Cycle now = self.around_.now;
    const bool locked = (osccon & kOSCCON["CLKLOCK"]) && (self.words_.fosc & kMonitorOff);
    if (mask == 0xFF00) {
        self.state_.low = kLowKeys;
        if (self.state_.high.opens(static_cast<std::uint8_t>(value >> 8), now, self.cpu_cycle()) && !locked)
            osccon = merge(osccon, value, kHighWritable);
        return;
    }
    if (mask != 0x00FF) return;  // word writes do not open it
    self.state_.high = kHighKeys;
    if (!self.state_.low.opens(static_cast<std::uint8_t>(value), now, self.cpu_cycle()) || locked) return;
    const std::uint16_t old = osccon;
    osccon = merge(osccon, value, kLowWritable);
    if (!(value & kOSCCON["CF"])) assign(osccon, kOSCCON["CF"], false);
    const auto present = static_cast<std::uint8_t>(kOSCCON["COSC"].of(osccon));
    const auto wanted = static_cast<std::uint8_t>(kOSCCON["NOSC"].of(osccon));
    if (!(osccon & kOSCCON["OSWEN"]) || (self.words_.fosc & kSwitchingOff) || wanted == present) {
        assign(osccon, kOSCCON["OSWEN"], false);
        self.around_.events.cancel(self.slot_);
    } else if (!(old & kOSCCON["OSWEN"])) {
        self.begin_switch(present, wanted);
    }
}

void Oscillator33F::write_divider(void* owner, std::uint16_t address, std::uint16_t value,
                                  std::uint16_t mask) {
    Oscillator33F& self = *static_cast<Oscillator33F*>(owner);
    self.around_.sfr.store(address, value, mask);
    self.change_rate(self.clock_, self.around_.now + 1, self.source_hertz(self.running_) / kClocksPerCycle);
    if (address == sfr33::CLKDIV && self.on_doze) self.on_doze(self.on_rate_owner);
}

void Oscillator33F::switch_due(void* owner, Cycle due) {
    Oscillator33F& self = *static_cast<Oscillator33F*>(owner);
    std::uint16_t& osccon = self.around_.sfr.raw(sfr33::OSCCON);
    assign(osccon, kOSCCON["OSWEN"], false);
    self.select(static_cast<std::uint8_t>(kOSCCON["NOSC"].of(osccon)), due);
}

}  // namespace puckloop::dspic
