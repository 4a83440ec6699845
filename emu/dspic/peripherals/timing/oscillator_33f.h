#pragma once
// The 33FJ's clock: configuration words FOSCSEL and FOSC, OSCCON with its unlock sequences, clock switching,
// the PLL (CLKDIV, PLLFBD), the RC oscillator's tuning (OSCTUN). Source: DS70286, oscillator chapter; fact
// sheets config_words.csv, semantics.md section 17.
//
// Deviations
//  1. A switch takes 10 new cycles; towards the primary oscillator 1024 crystal periods more, towards the PLL
//     1 ms more (the data sheet's AC table: 0.9 to 3.1 ms). The wait is counted in cycles of the old clock.
//  2. A switch between the two PLL modes, which the sheet forbids, is ignored.
//  3. Writing CLKDIV or PLLFBD while the PLL runs changes the rate at once, as OSCTUN does; PLLPOST 2
//  (reserved) divides by 4.
//  4. LPOSCEN is stored. The fail-safe monitor acts at once. DOZE, DOZEN and ROI are the core's
//  (core/doze.cpp).
//  5. OSCTUN moves the RC oscillator by its nominal 0.375 % a step (expected values of errata DS80280G, item
//  42), which silicon leaves between 16 and 31 and between -16 and -1; programming times stay nominal.

#include "emu/dspic/peripherals/timing/clock_control.h"

#include <cstdint>

namespace puckloop::dspic {

class Oscillator33F : public ClockControl {
  public:
    Oscillator33F(const Surroundings& around, cosim::ClockDomain& clock, double crystal_hertz);

    void configure(const ClockConfiguration& words) override { words_ = words; }
    void reset(bool power_on) override;
    bool crystal_stopped(Cycle at) override;
    double wake_seconds() const override;

    /// Instruction rate before any configuration word is known: the internal RC oscillator.
    static double start_hertz();

    template <class Archive>
    void state(Archive& archive) {
        archive(words_, running_, crystal_dead_, state_);
    }

  private:
    struct State {
        OscconKeys high = kHighKeys;
        OscconKeys low = kLowKeys;

        template <class Archive>
        void state(Archive& archive) {
            archive(high, low);
        }
    };

    static void write_osccon(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_divider(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void switch_due(void* owner, Cycle due);
    void begin_switch(std::uint8_t present, std::uint8_t wanted);
    void select(std::uint8_t source, Cycle at);
    double frc_hertz() const;
    double source_hertz(std::uint8_t source) const;
    double pll(double input) const;
    Cycle cpu_cycle() const;

    Surroundings around_;
    cosim::ClockDomain& clock_;
    double crystal_hertz_;
    ClockConfiguration words_;
    std::uint8_t running_ = 0;  ///< COSC, kept over resets other than power-on
    bool crystal_dead_ = false;
    State state_;
    EventQueue::Slot slot_;
};

}  // namespace puckloop::dspic
