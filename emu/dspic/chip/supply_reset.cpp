#include "emu/dspic/chip/supply_reset.h"

#include <algorithm>

namespace puckloop::dspic {

namespace {

constexpr std::uint32_t kFborpor30F = 0xF80004, kFpor33F = 0xF8000C;
constexpr unsigned kBoren = 1u << 7;
constexpr double kBrownOut[4] = {4.5, 4.2, 2.7, 2.0};  ///< volts by BORV
constexpr double kBrownOut33F = 2.475, kPowerOn = 1.85, kHysteresis = 5e-3;
constexpr double kPowerUp30F[4] = {0, 4e-3, 16e-3, 64e-3};  ///< seconds by FPWRT
constexpr double kPowerUp33F[8] = {0, 2e-3, 4e-3, 8e-3, 16e-3, 32e-3, 64e-3, 128e-3};

}  // namespace

SupplyReset::SupplyReset(Core& core, EventQueue& events, const Pins& pins)
    : core_(core), events_(events), pins_(pins), slot_(events.add(this, released)) {}

std::uint16_t SupplyReset::configuration() const {
    return core_.config(core_.device().family_33f ? kFpor33F : kFborpor30F);
}

bool SupplyReset::brown_out_on() const {
    return !core_.device().family_33f && configuration() & kBoren;
}

double SupplyReset::power_up_seconds() const {
    return core_.device().family_33f ? kPowerUp33F[configuration() & 7] : kPowerUp30F[configuration() & 3];
}

double SupplyReset::brown_out_volts() const {
    if (core_.device().family_33f) return kBrownOut33F;
    return brown_out_on() ? kBrownOut[configuration() >> 4 & 3] : 0.0;
}

double SupplyReset::lowest() const {
    return std::max(brown_out_volts(), kPowerOn) + (holds_ ? kHysteresis : 0.0);
}

void SupplyReset::changed(Cycle at, Cycle start_up) {
    const double volts = pins_.supply();
    if (holds_ && volts < kPowerOn) cause_ = ResetCause::PowerOn;
    if (volts < lowest()) {
        events_.cancel(slot_);  // a dip before the power-up timer's end: it begins anew
        if (!holds_) core_.reset(volts < brown_out_volts() ? ResetCause::BrownOut : ResetCause::PowerOn);
    } else if (holds_ && events_.due(slot_) == kNoCycle) {
        events_.schedule(slot_, at + start_up);
    }
}

void SupplyReset::reset(ResetCause cause) {
    if (pins_.supply() < lowest()) {
        if (!holds_) cause_ = pins_.supply() < kPowerOn ? ResetCause::PowerOn : cause;
        holds_ = true;
    } else if (holds_ && events_.due(slot_) != kNoCycle) {
        return;  // the power-up timer goes on
    } else {
        holds_ = false;
    }
    core_.hold(holds_);
}

// Once more, and it runs.
void SupplyReset::released(void* owner, Cycle) {
    SupplyReset& self = *static_cast<SupplyReset*>(owner);
    self.core_.request_reset(self.cause_);
}

}  // namespace puckloop::dspic
