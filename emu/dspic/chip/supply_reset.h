#pragma once
// The resets that VDD causes: brown-out and power-on, and the power-up timer behind both. Sources: dsPIC30F
// Family Reference Manual, section 8; DS70138G, figure 23-2 and parameters BO10, BO15 (a part of the family);
// configuration words FBORPOR (30F: BOREN, BORV, FPWRT) and FPOR (33FJ: FPWRT); DS70286, section 6.
//
// Deviations
//  1. Levels are the nominal ones of BORV (4.5, 4.2, 2.7 and 2.0 V), BOR has 5 mV of hysteresis and no delay.
//  2. The power-on reset acts below 1.85 V, its nominal threshold, whether or not VDD fell to 0.
//  3. A 33FJ's brown-out, which cannot be switched off, comes at 2.475 V, the middle of its range.
//  4. Power-up at time 0 takes no time; only a supply that comes back waits for the power-up timer and the
//     oscillator's start.

#include "emu/dspic/core/core.h"
#include "emu/dspic/machine/event_queue.h"
#include "emu/dspic/peripherals/pins.h"

#include <cstdint>

namespace puckloop::dspic {

class SupplyReset {
  public:
    SupplyReset(Core& core, EventQueue& events, const Pins& pins);

    /// VDD is another one from `at` on. `start_up`: cycles until the clock that a reset chooses runs.
    void changed(Cycle at, Cycle start_up);
    /// Any reset: without enough supply the chip stays in it.
    void reset(ResetCause cause);
    /// In reset until the supply has been back for long enough.
    bool holds() const { return holds_; }
    /// The 30F's brown-out detector is on (BOREN).
    bool brown_out_on() const;
    /// The power-up timer's time in seconds (FPWRT).
    double power_up_seconds() const;

    template <class Archive>
    void state(Archive& archive) {
        archive(holds_);
        archive.bounded(cause_, ResetCause::PowerOn, ResetCause::IllegalOpcode);
    }

  private:
    static void released(void* owner, Cycle due);
    std::uint16_t configuration() const;
    double brown_out_volts() const;  ///< 0: none
    double lowest() const;

    Core& core_;
    EventQueue& events_;
    const Pins& pins_;
    EventQueue::Slot slot_;
    bool holds_ = false;
    ResetCause cause_ = ResetCause::PowerOn;  ///< of the reset that holds
};

}  // namespace puckloop::dspic
