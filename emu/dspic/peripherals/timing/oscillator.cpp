#include "emu/dspic/peripherals/timing/oscillator.h"

#include "emu/dspic/devices/dspic30f6014a_sfr.h"
#include "emu/dspic/devices/register_bits.h"

#include <cmath>

namespace puckloop::dspic {

namespace {

constexpr double kLpHertz = 32'768.0;
constexpr double kFrcHertz = 7'370'000.0;
constexpr double kLprcHertz = 512'000.0;
constexpr int kClocksPerCycle = 4;
constexpr double kPostscale[] = {1.0, 4.0, 16.0, 64.0};  // POST

// FOS codes; the primary oscillator and the PLL are distinguished further by FPR.
enum Source : std::uint8_t { kLp = 0, kFrc = 1, kLprc = 2, kPrimary = 3, kPll = 7 };

constexpr RegisterBits kOSCCON{"OSCCON"};
constexpr std::uint16_t kLowWritable = kOSCCON["POST"] | kOSCCON["LPOSCEN"] | kOSCCON["OSWEN"];
constexpr std::uint16_t kHighWritable = kOSCCON["NOSC"];
constexpr std::uint16_t kSwitchingOff = bit(15);  // FOSC<FCKSM1>
constexpr std::uint16_t kMonitorOff = bit(14);    // FOSC<FCKSM0>

constexpr Cycle kSwitchCycles = 10;

}  // namespace

ClockChoice decode_fosc(std::uint16_t fosc, double crystal_hertz) {
    const auto source = static_cast<std::uint8_t>(field(fosc, 10, 8));
    const unsigned fpr = field(fosc, 4, 0);
    switch (source) {
    case kLp:
        return {kLpHertz, source};
    case kFrc:
        return {kFrcHertz, source};
    case kLprc:
        return {kLprcHertz, source};
    case kPrimary:
        return {crystal_hertz, source};
    default:
        break;
    }
    constexpr double kMultiplier[] = {0.0, 4.0, 8.0, 16.0};
    switch (fpr) {
    case 0b00001:
        return {kFrcHertz * 4.0, kPll};
    case 0b01010:
        return {kFrcHertz * 8.0, kPll};
    case 0b00011:
        return {kFrcHertz * 16.0, kPll};
    case 0b00101:
    case 0b00110:
    case 0b00111:  // XT
    case 0b01101:
    case 0b01110:
    case 0b01111:  // ECIO
        return {crystal_hertz * kMultiplier[fpr & 3u], kPll};
    case 0b10001:
    case 0b10010:
    case 0b10011:  // HS/2
        return {crystal_hertz / 2.0 * kMultiplier[fpr & 3u], kPll};
    case 0b10101:
    case 0b10110:
    case 0b10111:  // HS/3
        return {crystal_hertz / 3.0 * kMultiplier[fpr & 3u], kPll};
    default:
        return {crystal_hertz * 8.0, kPll};
    }
}

Oscillator::Oscillator(const Surroundings& around, cosim::ClockDomain& clock, double crystal_hertz)
    : around_(around),
      clock_(clock),
      crystal_hertz_(crystal_hertz),
      slot_(around.events.add(this, switch_due)) {
    around_.sfr.hook(sfr::OSCCON, this, nullptr, write_osccon);
    around_.sfr.claim(sfr::OSCTUN);
}

void Oscillator::reset(bool) {
    state_ = {};
    around_.events.cancel(slot_);
    select(decode_fosc(fosc_, crystal_hertz_).source, around_.now);
    std::uint16_t& osccon = around_.sfr.raw(sfr::OSCCON);
    osccon = static_cast<std::uint16_t>((osccon & ~kHighWritable) | kOSCCON["COSC"].of(osccon) << 8);
}

double Oscillator::source_hertz(std::uint8_t source) const {
    const auto fosc = static_cast<std::uint16_t>((fosc_ & ~0x0700u) | static_cast<unsigned>(source) << 8);
    return decode_fosc(fosc, crystal_hertz_).hertz;
}

// Runs on `source` from cycle `at` on, with the present postscaler.
void Oscillator::select(std::uint8_t source, Cycle at) {
    std::uint16_t& osccon = around_.sfr.raw(sfr::OSCCON);
    osccon = static_cast<std::uint16_t>((osccon & ~0x7000u) | static_cast<unsigned>(source) << 12);
    assign(osccon, kOSCCON["LOCK"], source == kPll);
    const double hertz = source_hertz(source) / kClocksPerCycle / kPostscale[kOSCCON["POST"].of(osccon)];
    change_rate(clock_, at, hertz);
}

// The PLL may run from the internal oscillator.
bool Oscillator::needs_crystal(std::uint8_t source) const {
    const unsigned fpr = field(fosc_, 4, 0);
    return source == kPrimary || (source == kPll && fpr != 0b00001 && fpr != 0b01010 && fpr != 0b00011);
}

bool Oscillator::crystal_stopped(Cycle at) {
    crystal_dead_ = true;
    std::uint16_t& osccon = around_.sfr.raw(sfr::OSCCON);
    if (!needs_crystal(static_cast<std::uint8_t>(kOSCCON["COSC"].of(osccon)))) return true;
    if (fosc_ & (kSwitchingOff | kMonitorOff)) return false;
    around_.events.cancel(slot_);
    assign(osccon, kOSCCON["OSWEN"], false);
    osccon |= kOSCCON["CF"];
    select(kFrc, at);
    around_.interrupts.raise_trap(Trap::OscillatorFail, at);
    return true;
}

double Oscillator::wake_seconds() const {
    const auto source = static_cast<std::uint8_t>(kOSCCON["COSC"].of(around_.sfr.raw(sfr::OSCCON)));
    constexpr unsigned kExternalClock = 0b01;  // FPR<4:3>: nothing has to start
    double seconds = kPowerOnSeconds;
    if (needs_crystal(source) && field(fosc_, 4, 3) != kExternalClock)
        seconds += kStartupPeriods / crystal_hertz_;
    if (source == kPll) seconds += kLockSeconds30F;
    if (!(fosc_ & (kSwitchingOff | kMonitorOff))) seconds += kMonitorSeconds;
    return seconds;
}

void Oscillator::write_osccon(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Oscillator& self = *static_cast<Oscillator*>(owner);
    std::uint16_t& osccon = self.around_.sfr.raw(address);
    if (mask == 0xFF00) {
        self.state_.low = kLowKeys;
        if (self.state_.high.opens(static_cast<std::uint8_t>(value >> 8), self.around_.now))
            osccon = merge(osccon, value, kHighWritable);
        return;
    }
    if (mask != 0x00FF) return;  // word writes do not open it
    self.state_.high = kHighKeys;
    if (!self.state_.low.opens(static_cast<std::uint8_t>(value), self.around_.now)) return;
    const std::uint16_t old = osccon;
    osccon = merge(osccon, value, kLowWritable);
    if (!(value & kOSCCON["CF"])) assign(osccon, kOSCCON["CF"], false);
    const auto present = static_cast<std::uint8_t>(kOSCCON["COSC"].of(osccon));
    const auto wanted = static_cast<std::uint8_t>(kOSCCON["NOSC"].of(osccon));
    if (!(osccon & kOSCCON["OSWEN"]) || (self.fosc_ & kSwitchingOff) || wanted == present) {
        assign(osccon, kOSCCON["OSWEN"], false);
        self.around_.events.cancel(self.slot_);
    } else if (!(old & kOSCCON["OSWEN"])) {
        if (self.crystal_dead_ && self.needs_crystal(wanted)) return;  // waits for it for ever
        double wait = 0.0;
        if (wanted == kPrimary || wanted == kPll)
            wait = kStartupPeriods / self.crystal_hertz_ * self.clock_.hertz();
        self.around_.events.schedule(self.slot_, self.around_.now + 1 + kSwitchCycles +
                                                     static_cast<Cycle>(std::llround(wait)));
    }
    if ((old ^ osccon) & kOSCCON["POST"]) self.select(present, self.around_.now + 1);
}

void Oscillator::switch_due(void* owner, Cycle due) {
    Oscillator& self = *static_cast<Oscillator*>(owner);
    std::uint16_t& osccon = self.around_.sfr.raw(sfr::OSCCON);
    assign(osccon, kOSCCON["OSWEN"], false);
    self.select(static_cast<std::uint8_t>(kOSCCON["NOSC"].of(osccon)), due);
}

}  // namespace puckloop::dspic
