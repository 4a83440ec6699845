#include "emu/avr/peripherals/system_control.h"

#include "emu/avr/peripherals/shared_registers.h"

#include <algorithm>
#include <utility>

namespace puckloop::avr {

namespace {
constexpr std::uint16_t kOcdr = 0x51, kSmcr = 0x53, kClkpr = 0x61, kPrr1 = 0x65, kAssr = 0xB6;
constexpr std::uint8_t kSe = bit(0);                                     // SMCR
constexpr std::uint8_t kPorf = bit(0), kExtrf = bit(1), kBorf = bit(2);  // MCUSR
constexpr std::uint8_t kJtd = bit(7), kBods = bit(6), kBodse = bit(5), kIvsel = bit(1),
                       kIvce = bit(0);  // MCUCR
constexpr Cycle kBrownOutSleep = 3;     ///< clocks in which SLEEP must follow BODS
constexpr double kBrownOutStartUp = 60e-6;
constexpr std::uint8_t kClkpce = bit(7);  // CLKPR
constexpr Cycle kClkpceArmed = 4;
constexpr unsigned kSlowest = 8, kByEight = 3;  // CLKPS
}  // namespace

SystemControl::SystemControl(const Surroundings& around, Core& core, cosim::ClockDomain& clock,
                             const Fuses& fuses, double oscillator_hertz)
    : around_(around), core_(core), clock_(clock), fuses_(fuses), oscillator_hertz_(oscillator_hertz) {
    around_.io.hook(kMcusr, this, nullptr, &write_flags);
    around_.io.hook(kMcucr, this, &read_mcucr, &write_mcucr);
    around_.io.hook(kClkpr, this, nullptr, &write_prescaler);
    around_.io.hook(kPrr0, this, nullptr, &write_power);
    around_.io.hook(kPrr1, this, nullptr, &write_power);
    around_.io.hook(kOsccal, this, nullptr, &write_reported);
    around_.io.hook(kOcdr, this, nullptr, &write_reported);
    around_.io.claim(kSmcr);
}

void SystemControl::write_reported(void* owner, std::uint16_t address, std::uint8_t value,
                                   std::uint8_t mask) {
    auto& self = *static_cast<SystemControl*>(owner);
    self.around_.io.store(address, value, mask);
    self.around_.io.report_unmodelled(address, address == kOsccal ? "OSCCAL" : "OCDR", true);
}

// CKSEL3:0 (data sheet, "Clock Sources"): whatever is not internal is what is connected.
double SystemControl::source_hertz() const {
    constexpr unsigned kInternalRc = 2, kInternal128k = 3;
    constexpr double kRcHertz = 8e6, kSlowHertz = 128e3;
    const unsigned select = field(fuses_.low, 3, 0);
    return select == kInternalRc ? kRcHertz : select == kInternal128k ? kSlowHertz : oscillator_hertz_;
}

bool SystemControl::jtag() const {
    return fuses_.jtag() && !(around_.io.raw(kMcucr) & kJtd);
}

void SystemControl::reset(ResetCause cause) {
    std::uint8_t& flags = around_.io.raw(kMcusr);
    switch (cause) {
    case ResetCause::PowerOn:
        flags = kPorf;
        break;
    case ResetCause::External:
        flags |= kExtrf;
        break;
    case ResetCause::BrownOut:
        flags |= kBorf;
        break;
    case ResetCause::Watchdog:
        flags |= kWdrf;
        break;
    }
    changeable_until_ = vectors_changeable_until_ = jtag_until_ = 0;
    brown_out_from_ = brown_out_until_ = 0;
    brown_out_off_ = false;
    interrupts_held_until_ = 0;
    set_divider(fuses_.divide_clock() ? kByEight : 0);
}

std::uint32_t SystemControl::boot_start() const {
    return core_.device().flash_words - fuses_.boot_words();
}
std::uint16_t SystemControl::vector_base() const {
    return around_.io.raw(kMcucr) & kIvsel ? static_cast<std::uint16_t>(boot_start()) : std::uint16_t{0};
}
std::uint16_t SystemControl::reset_pc() const {
    return fuses_.boot_reset() ? static_cast<std::uint16_t>(boot_start()) : std::uint16_t{0};
}

// Data sheet, "Power Management and Sleep Modes", table 10-1: which vectors wake. Timer 2 does from the
// deeper modes only with its own clock, and only from those in which its oscillator runs.
void SystemControl::sleep() {
    const unsigned control = around_.io.raw(kSmcr);
    if (!(control & kSe)) return;
    const auto vectors = [](int first, int last) {
        return (std::uint64_t{2} << last) - (std::uint64_t{1} << first);
    };
    constexpr int kInt0 = 1, kWatchdog = 8, kTimer2 = 9, kTimer2Overflow = 11, kAdcReady = 24, kEeprom = 25,
                  kTwi = 26, kSpm = 27;
    const bool own_clock = around_.io.raw(kAssr) & kAs2;
    const std::uint64_t timer2 = own_clock ? vectors(kTimer2, kTimer2Overflow) : 0;
    const std::uint64_t deep = vectors(kInt0, kWatchdog) | vectors(kTwi, kTwi);
    enum Mode : unsigned { kIdle, kNoiseReduction, kPowerDown, kPowerSave, kStandby = 6, kExtendedStandby };
    constexpr std::uint32_t kStandbyStartUp = 6;
    const auto stop = [&](bool timer2_too) {
        if (stop_clocks) stop_clocks(true, timer2_too || !own_clock);
    };
    const unsigned mode = field(control, 3, 1);
    const bool deeper =
        mode == kPowerDown || mode == kPowerSave || mode == kStandby || mode == kExtendedStandby;
    brown_out_off_ = deeper && around_.now < brown_out_until_;
    switch (mode) {
    case kNoiseReduction:
        stop(false);
        core_.sleep(deep | timer2 | vectors(kAdcReady, kEeprom) | vectors(kSpm, kSpm), 0);
        if (quiet_conversion) quiet_conversion();
        return;
    case kPowerDown:
        stop(true);
        return core_.sleep(deep, brown_out_start_up(fuses_.start_up_clocks()));
    case kPowerSave:
        stop(false);
        return core_.sleep(deep | timer2, brown_out_start_up(fuses_.start_up_clocks()));
    case kStandby:
        stop(true);
        return core_.sleep(deep, brown_out_start_up(kStandbyStartUp));
    case kExtendedStandby:
        stop(false);
        return core_.sleep(deep | timer2, brown_out_start_up(kStandbyStartUp));
    default:
        core_.sleep(~std::uint64_t{0}, 0);
        if (quiet_conversion) quiet_conversion();
        return;
    }
}

void SystemControl::wake() {
    const bool on_again = std::exchange(brown_out_off_, false);
    if (stop_clocks) stop_clocks(false, true);
    if (on_again && brown_out_on) brown_out_on();
}

// Where it was off, waking takes at least so long that the brown-out detector works (data sheet, "BOD
// Disable").
std::uint32_t SystemControl::brown_out_start_up(std::uint32_t clocks) const {
    if (!brown_out_off_ || fuses_.brown_out_volts() == 0) return clocks;
    return std::max(clocks, static_cast<std::uint32_t>(kBrownOutStartUp * clock_.hertz()));
}

// A zero written clears a flag, a one leaves it.
void SystemControl::write_flags(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<SystemControl*>(owner);
    self.around_.io.raw(address) &= static_cast<std::uint8_t>(value | ~mask);
}

// BODS is set for three clocks.
std::uint8_t SystemControl::read_mcucr(void* owner, std::uint16_t address) {
    const auto& self = *static_cast<SystemControl*>(owner);
    std::uint8_t value = self.around_.io.raw(address);
    assign(value, kBods, self.around_.now < self.brown_out_until_);
    return value;
}

// IVSEL changes within four clocks after IVCE was set, with interrupts held back for as long, or up to the
// instruction behind the change; JTD when it is written twice within four, BODS within
// four after BODS and BODSE were set.
void SystemControl::write_mcucr(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<SystemControl*>(owner);
    const Cycle now = self.around_.now;
    const auto written = static_cast<std::uint8_t>(value & mask);
    const std::uint8_t old = self.around_.io.raw(address);
    const auto changeable = static_cast<std::uint8_t>(now < self.vectors_changeable_until_ ? kIvsel : 0);
    self.vectors_changeable_until_ = written & kIvce ? now + 1 + kClkpceArmed : 0;
    if (written & kIvce)
        self.interrupts_held_until_ = now + 1 + kClkpceArmed;
    else if (changeable)
        self.interrupts_held_until_ = now + 2;

    std::uint8_t jtd = 0;
    if (mask & kJtd) {
        const bool wanted = value & kJtd;
        if (now < self.jtag_until_ && wanted == self.jtag_wanted_)
            jtd = kJtd;
        else
            self.jtag_until_ = now + 1 + kClkpceArmed;
        self.jtag_wanted_ = wanted;
    }
    if ((written & kBods) && (written & kBodse))
        self.brown_out_from_ = now + 1 + kClkpceArmed;
    else if ((written & kBods) && now < self.brown_out_from_)
        self.brown_out_until_ = now + 1 + kBrownOutSleep;
    self.around_.io.store(address, value, mask & (kPud | changeable | jtd));

    const auto changed = static_cast<std::uint8_t>(old ^ self.around_.io.raw(address));
    if ((changed & kJtd) && self.jtag_changed) self.jtag_changed();
    if ((changed & kPud) && self.pull_ups_changed) self.pull_ups_changed();
}

void SystemControl::set_divider(unsigned select) {
    around_.io.raw(kClkpr) = static_cast<std::uint8_t>(select);
    const double hertz = source_hertz() / (1u << std::min(select, kSlowest));
    if (hertz == clock_.hertz()) return;
    if (rate_changes) rate_changes(false);
    clock_.change_rate(around_.now + 1, hertz);
    if (rate_changes) rate_changes(true);
    core_.end_run();
}

// CLKPS changes within four clocks after CLKPCE was written alone.
void SystemControl::write_prescaler(void* owner, std::uint16_t, std::uint8_t value, std::uint8_t) {
    auto& self = *static_cast<SystemControl*>(owner);
    if (value == kClkpce)
        self.changeable_until_ = self.around_.now + 1 + kClkpceArmed;
    else if (!(value & kClkpce) && self.around_.now < self.changeable_until_)
        self.set_divider(field(value, 3, 0));
}

void SystemControl::write_power(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<SystemControl*>(owner);
    if (self.synchronise) self.synchronise();
    self.around_.io.store(address, value, mask);
    if (self.synchronise) self.synchronise();
}

}  // namespace puckloop::avr
