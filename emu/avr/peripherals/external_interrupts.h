#pragma once
// INT0..2 on PD2, PD3 and PB2, and the pin-change interrupts PCINT0..31. Source: data sheet 8272, "External
// Interrupts".
//
// Deviations
//  1. Edges are seen at once; the data sheet's synchroniser delays them by up to two clocks.

#include "emu/avr/peripherals/interrupt_flags.h"
#include "emu/avr/peripherals/ports.h"

namespace puckloop::avr {

class ExternalInterrupts {
  public:
    ExternalInterrupts(const Surroundings& around, Ports& ports);
    /// EIFR and EIMSK.
    InterruptFlags& edges() { return edges_; }

  private:
    static constexpr int kCount = 3;
    static constexpr Pin kPins[kCount] = {{PortLetter::D, 2}, {PortLetter::D, 3}, {PortLetter::B, 2}};
    unsigned sense(int number) const;
    void update_levels();
    static void write_sense(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void changed(void* owner, PortLetter port, std::uint8_t before, std::uint8_t after, Cycle now);
    static void touched(void* owner);

    Surroundings around_;
    Ports& ports_;
    InterruptFlags edges_;
    InterruptFlags changes_;
};

}  // namespace puckloop::avr
