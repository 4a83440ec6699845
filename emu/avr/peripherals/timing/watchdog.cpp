#include "emu/avr/peripherals/timing/watchdog.h"

#include "emu/avr/peripherals/shared_registers.h"

#include <algorithm>

namespace puckloop::avr {

namespace {
constexpr int kWatchdogVector = 8;
constexpr std::uint16_t kWdtcsr = 0x60;
constexpr std::uint8_t kWdif = bit(7), kWdie = bit(6), kWdce = bit(4), kWde = bit(3), kWdp = 0x27;
constexpr Cycle kWdceArmed = 4;
constexpr double kOscillator = 128e3;
constexpr unsigned kShortest = 2048, kLongestSelect = 9;
}  // namespace

Watchdog::Watchdog(const Surroundings& around, Core& core, const cosim::ClockDomain& clock)
    : around_(around), core_(core), clock_(clock), slot_(around.events.add(this, &due)) {
    around_.io.hook(kWdtcsr, this, nullptr, &write_control);
    around_.interrupts.connect(kWatchdogVector, this, &acknowledge);
}

void Watchdog::reset(bool always_on) {
    always_on_ = always_on;
    changeable_until_ = 0;
    control() = always_on || (around_.io.raw(kMcusr) & kWdrf) ? kWde : 0;
    plan(around_.now);
}

void Watchdog::rate_changes(bool changed) {
    const Cycle due = around_.events.due(slot_);
    if (due == kNoCycle) return;
    if (changed)
        around_.events.schedule(slot_, clock_.first_cycle_at(kept_));
    else
        kept_ = clock_.time_of(due);
}

void Watchdog::restart() {
    plan(around_.now + 1);
}

Cycle Watchdog::period(std::uint8_t control) const {
    const unsigned select = std::min(field(control, 2, 0) | field(control, 5, 5) << 3, kLongestSelect);
    const double seconds = static_cast<double>(kShortest << select) / kOscillator;
    return static_cast<Cycle>(seconds * clock_.hertz());
}

void Watchdog::plan(Cycle from) {
    if (!(control() & (kWde | kWdie))) return around_.events.cancel(slot_);
    around_.events.schedule(slot_, from + period(control()));
}

// Only WDR, a time-out and a reset set the counter to 0: with another period it goes on from where it is, and
// one that is past the new period is a time-out.
void Watchdog::change_period(std::uint8_t old, Cycle now) {
    const Cycle due = around_.events.due(slot_);
    const bool ran = (old & (kWde | kWdie)) != 0 && due != kNoCycle;
    if (!ran || !(control() & (kWde | kWdie))) return plan(now);
    around_.events.schedule(slot_, std::max(now, due + period(control()) - period(old)));
}

void Watchdog::update_request() {
    around_.interrupts.request(kWatchdogVector, (control() & kWdif) && (control() & kWdie));
}

// With both modes on, the routine's entry leaves the interrupt mode: the next time-out resets.
void Watchdog::acknowledge(void* owner, int) {
    auto& self = *static_cast<Watchdog*>(owner);
    assign(self.control(), kWdif, false);
    if (self.control() & kWde) assign(self.control(), kWdie, false);
    self.update_request();
}

void Watchdog::due(void* owner, Cycle cycle) {
    auto& self = *static_cast<Watchdog*>(owner);
    constexpr std::uint8_t kUnserved = kWde | kWdif;  // both modes, and the routine has not run since
    if ((self.control() & kWdie) && (self.control() & kUnserved) != kUnserved) {
        self.control() |= kWdif;
        self.update_request();
        self.plan(cycle);
    } else {
        self.core_.request_reset(ResetCause::Watchdog);
    }
}

// WDE and the prescaler only change within four clocks after WDCE and WDE were written together. WDE cannot
// be cleared while MCUSR.WDRF is set; with the fuse WDTON neither it nor WDIE changes.
void Watchdog::write_control(void* owner, std::uint16_t, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Watchdog*>(owner);
    const std::uint8_t old = self.control();
    const Cycle now = self.around_.now;
    std::uint8_t next = merged(old, value, mask & kWdie);
    if (value & mask & kWdif) assign(next, kWdif, false);
    if (now < self.changeable_until_)
        next = merged(next, value, mask & (kWdp | kWde));
    else
        next |= value & mask & kWde;  // setting it needs no sequence
    if (self.always_on_ || (self.around_.io.raw(kMcusr) & kWdrf)) next |= kWde;
    if (self.always_on_) assign(next, kWdie, false);
    if ((value & mask & kWdce) && (value & mask & kWde)) self.changeable_until_ = now + 1 + kWdceArmed;
    self.control() = static_cast<std::uint8_t>(next & ~kWdce);
    if ((old ^ self.control()) & (kWde | kWdie | kWdp)) self.change_period(old, now + 1);
    self.update_request();
}

}  // namespace puckloop::avr
