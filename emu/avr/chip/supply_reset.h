#pragma once
// The resets that VCC causes: power-on and brown-out, and the start-up time behind both. Source: data sheet
// 8272, "System Control and Reset" (VBOT+ and VBOT- are half of VHYST beside the level), "System Clock"
// (start- up times by CKSEL and SUT) and "System and Reset Characteristics" (VPOT 1.3 V, VHYST 50 mV, tBOD 2
// us).
//
// Deviations
//  1. Typical figures; the time-out's oscillator is exact: 4.1 and 65 ms.
//  2. Below 1.3 V the chip is reset as by power-on, whether or not VCC fell to 0; its RAM keeps its contents.
//  3. Power-up at time 0 with enough supply, and the resets that VCC does not cause, take no start-up time.

#include "cosim/core/clock.h"
#include "emu/avr/core/core.h"
#include "emu/avr/devices/fuses.h"
#include "emu/avr/peripherals/system_control.h"

namespace puckloop::avr {

class SupplyReset {
  public:
    SupplyReset(Core& core, EventQueue& events, const SystemControl& system, const Fuses& fuses,
                const cosim::ClockDomain& clock, double volts);

    /// VCC is `volts` from cycle `at` on.
    void set(double volts, Cycle at);
    double volts() const { return volts_; }
    /// Any reset: without enough supply the chip stays in it.
    void reset(ResetCause cause);
    /// The brown-out detector works again, which had been off for a sleep.
    void detector_on();
    /// In reset until the supply has been back for long enough.
    bool holds() const { return holds_; }

    template <class Archive>
    void state(Archive& archive) {
        archive.bounded(volts_, 0.0, 1e3);
        archive(holds_);
        archive.bounded(cause_, ResetCause::PowerOn, ResetCause::Watchdog);
    }

  private:
    static void tripped(void* owner, Cycle due);
    static void released(void* owner, Cycle due);
    double falling() const;  ///< resets below
    double rising() const;   ///< ends a reset
    Cycle start_up() const;
    bool counts() const { return events_.due(release_slot_) != kNoCycle; }

    Core& core_;
    EventQueue& events_;
    const SystemControl& system_;
    const Fuses& fuses_;
    const cosim::ClockDomain& clock_;
    EventQueue::Slot trip_slot_, release_slot_;
    double volts_;
    bool holds_ = false;
    ResetCause cause_ = ResetCause::PowerOn;  ///< of the reset that holds
};

}  // namespace puckloop::avr
