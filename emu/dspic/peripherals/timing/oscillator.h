#pragma once
// The 30F's clock: configuration word FOSC, OSCCON with its unlock sequences, clock switching, PLL and
// postscaler.
// Source: dsPIC30F Family Reference Manual, section 7; fact sheets config_words.csv and semantics.md
// section 17.
//
// Deviations
//  1. A reserved FOSC code runs as the crystal with the 8x PLL.
//  2. The fail-safe clock monitor acts at once, not within 2 ms; OSCTUN and LPOSCEN are stored.
//  3. A switch takes 10 old cycles, and 1024 crystal periods more towards the primary oscillator; PLL lock
//     is at once. After Sleep the
//     same oscillator starts: typical times (wake_seconds()).

#include "emu/dspic/peripherals/timing/clock_control.h"

#include <cstdint>

namespace puckloop::dspic {

/// What a FOSC word and a crystal make.
struct ClockChoice {
    double hertz = 0.0;       ///< of the oscillator after the PLL, four of which make an instruction cycle
    std::uint8_t source = 0;  ///< FOS code: 0 LP, 1 FRC, 2 LPRC, 3 primary, 7 PLL
};
ClockChoice decode_fosc(std::uint16_t fosc, double crystal_hertz);

class Oscillator : public ClockControl {
  public:
    Oscillator(const Surroundings& around, cosim::ClockDomain& clock, double crystal_hertz);

    void configure(const ClockConfiguration& words) override { fosc_ = words.fosc; }
    void reset(bool power_on) override;
    bool crystal_stopped(Cycle at) override;
    double wake_seconds() const override;

    template <class Archive>
    void state(Archive& archive) {
        archive(fosc_, crystal_dead_, state_);
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
    static void switch_due(void* owner, Cycle due);
    void select(std::uint8_t source, Cycle at);
    double source_hertz(std::uint8_t source) const;
    bool needs_crystal(std::uint8_t source) const;

    Surroundings around_;
    cosim::ClockDomain& clock_;
    double crystal_hertz_;
    std::uint16_t fosc_ = 0xFFFF;
    bool crystal_dead_ = false;
    State state_;
    EventQueue::Slot slot_;
};

}  // namespace puckloop::dspic
