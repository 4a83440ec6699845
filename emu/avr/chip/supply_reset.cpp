#include "emu/avr/chip/supply_reset.h"

#include <algorithm>
#include <cmath>

namespace puckloop::avr {

namespace {
constexpr double kPowerOnVolts = 1.3, kHysteresisVolts = 0.05;
constexpr double kShortestBrownOut = 2e-6;  // s, tBOD
constexpr double kDividedBy = 8;            // CKDIV8
}  // namespace

SupplyReset::SupplyReset(Core& core, EventQueue& events, const SystemControl& system, const Fuses& fuses,
                         const cosim::ClockDomain& clock, double volts)
    : core_(core),
      events_(events),
      system_(system),
      fuses_(fuses),
      clock_(clock),
      trip_slot_(events.add(this, tripped)),
      release_slot_(events.add(this, released)),
      volts_(volts) {}

double SupplyReset::falling() const {
    const double level = system_.brown_out_off() ? 0.0 : fuses_.brown_out_volts();
    return std::max(level - kHysteresisVolts / 2, kPowerOnVolts);
}

double SupplyReset::rising() const {
    return std::max(fuses_.brown_out_volts() + kHysteresisVolts / 2, kPowerOnVolts + kHysteresisVolts);
}

// In the clock that the reset has chosen.
Cycle SupplyReset::start_up() const {
    const StartUp time = fuses_.reset_start_up();
    const double clocks = time.clocks / (fuses_.divide_clock() ? kDividedBy : 1.0);
    return static_cast<Cycle>(std::llround(clocks + time.seconds * clock_.hertz()));
}

void SupplyReset::set(double volts, Cycle at) {
    volts_ = volts;
    if (volts < kPowerOnVolts && !(holds_ && cause_ == ResetCause::PowerOn)) {
        events_.cancel(trip_slot_);
        events_.cancel(release_slot_);
        holds_ = false;  // a reset of its own, even in one by the brown-out detector
        core_.reset(ResetCause::PowerOn);
    } else if (holds_) {
        if (volts < falling())
            events_.cancel(release_slot_);  // a dip before the end of the start-up time: it begins anew
        else if (volts >= rising() && !counts())
            events_.schedule(release_slot_, at + start_up());
    } else if (volts >= falling()) {
        events_.cancel(trip_slot_);
    } else if (events_.due(trip_slot_) == kNoCycle) {
        events_.schedule(trip_slot_,
                         at + static_cast<Cycle>(std::llround(kShortestBrownOut * clock_.hertz())));
    }
}

void SupplyReset::detector_on() {
    if (!holds_ && volts_ < falling()) core_.request_reset(ResetCause::BrownOut);
}

void SupplyReset::reset(ResetCause cause) {
    // Within tBOD the chip runs on, and its detector acts then: with a flag of its own.
    if (cause != ResetCause::PowerOn && events_.due(trip_slot_) != kNoCycle) return;
    events_.cancel(trip_slot_);
    if (volts_ < (holds_ ? rising() : falling()) && !counts()) {
        if (!holds_) cause_ = volts_ < kPowerOnVolts ? ResetCause::PowerOn : cause;
        holds_ = true;
    } else if (!counts()) {
        holds_ = false;
    }
    if (holds_) core_.stall_until(kNoCycle);
}

void SupplyReset::tripped(void* owner, Cycle) {
    SupplyReset& self = *static_cast<SupplyReset*>(owner);
    if (self.volts_ < self.falling()) self.core_.request_reset(ResetCause::BrownOut);
}

// Once more, and it runs.
void SupplyReset::released(void* owner, Cycle) {
    SupplyReset& self = *static_cast<SupplyReset*>(owner);
    self.core_.request_reset(self.cause_);
}

}  // namespace puckloop::avr
