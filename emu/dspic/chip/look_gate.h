#pragma once
// Runs of a chip to where its program would look at what the board does not know yet.

#include "emu/dspic/chip/chip.h"
#include "emu/dspic/machine/gate.h"

#include <span>
#include <string_view>
#include <vector>

namespace puckloop::dspic {

class LookGate {
  public:
    /// `looks`: registers whose access looks at the unknown, or moves what it depends on. `modules`: control
    /// registers of modules that could do so by themselves, once they are not as after a reset; A/D
    /// converters count by themselves.
    LookGate(Chip& chip, std::span<const std::string_view> looks, std::span<const std::string_view> modules);

    /// Nothing looks but the program: no module is at work that would.
    bool applies() const;
    /// From now on Chip::run_until() ends before a look at `known` or later; its now() gives where.
    void open(cosim::Time known);
    /// It looks whenever it likes again.
    void lift();
    /// The last run ended before a look.
    bool held() const;

  private:
    struct Module {
        std::uint16_t address = 0;
        std::uint16_t after_reset = 0;
    };

    Chip::Inside inside_;
    RegisterSet registers_;
    std::vector<Module> modules_;
    std::vector<std::uint16_t> converters_;  ///< ADxCON1
    std::uint16_t oscillator_ = 0;           ///< OSCCON
};

}  // namespace puckloop::dspic
