#pragma once
// The 30F's low-voltage detector: RCON's LVDEN, LVDL and BGST, and the interrupt when VDD falls below the
// trip point. Source: dsPIC30F Family Reference Manual, section 9; DS70143, tables of the DC (LV10: trip
// points) and AC characteristics (TBGAP: start of the band gap).
//
// Deviations
//  1. Trip points are the middle of the data sheet's range, without hysteresis; LVDL 0 to 3 (not usable)
//  never trip,
//     nor does 15 (the pin LVDIN).
//  2. The band gap takes its typical 40 us to start. With the brown-out detector on (BOREN) it is up at every
//  reset.
//  3. LVDIF is set when the condition begins; cleared by the program, it comes again when the supply falls
//  again or
//     the detector is switched on again.

#include "emu/dspic/peripherals/pins.h"
#include "emu/dspic/peripherals/surroundings.h"

#include <cstdint>

namespace puckloop::dspic {

class LowVoltage {
  public:
    LowVoltage(const Surroundings& around, std::uint8_t irq, Pins& pins);

    /// `brown_out`: BOREN of the configuration words, which keeps the band gap up.
    void reset(bool brown_out);
    /// RCON was written. `cycle_hertz`: instruction rate.
    void changed(double cycle_hertz);
    /// VDD is another one from `at` on.
    void supply_changed(Cycle at) { look(at); }

    template <class Archive>
    void state(Archive& archive) {
        archive(brown_out_, below_);
    }

  private:
    static void due(void* owner, Cycle due);
    void look(Cycle at);
    std::uint16_t& rcon() const;

    Surroundings around_;
    std::uint8_t irq_;
    Pins& pins_;
    EventQueue::Slot slot_;
    bool brown_out_ = false;
    bool below_ = false;  ///< what was last found
};

}  // namespace puckloop::dspic
