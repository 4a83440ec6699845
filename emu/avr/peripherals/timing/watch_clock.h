#pragma once
// What clocks timer 2 when ASSR.AS2 is set: a watch crystal between TOSC1 and TOSC2, or (EXCLK) a signal at
// TOSC1. It runs in simulated time, whatever the CPU's clock does. Source: data sheet 8272,
// "Asynchronous Operation of Timer/Counter2".
//
// Deviations
//  1. The crystal oscillates from the start (the data sheet states up to a second) and has no error; it stops
//  neither in power-down nor in standby, only what it clocks does.
//  2. The CPU sees each edge three of its clocks late; the compare pins follow then, not with the edge.

#include "cosim/core/clock.h"
#include "emu/avr/devices/device.h"

#include <cstdint>
#include <functional>

namespace puckloop::avr {

class WatchClock {
  public:
    /// `hertz` of the crystal, 0: none is fitted.
    WatchClock(const cosim::ClockDomain& clock, std::uint32_t hertz) : clock_(clock), hertz_(hertz) {}

    /// Rising edges that the CPU has seen up to and including cycle `at`.
    std::uint64_t edges(Cycle at) const;
    /// The cycle in which it has seen `n` of them, n > edges(now); kNoCycle if that cannot be known.
    Cycle edge(std::uint64_t n) const;
    bool fitted() const { return hertz_ != 0; }

    /// The pin's edges count instead of the crystal's.
    void use_pin(bool on) { pin_ = on; }
    bool uses_pin() const { return pin_; }
    void pin_rose() { ++pin_edges_; }

    /// Called when a program selects a crystal that is not there.
    std::function<void()> missing;

    template <class Archive>
    void state(Archive& archive) {
        archive(pin_, pin_edges_);
    }

  private:
    const cosim::ClockDomain& clock_;
    std::uint32_t hertz_;
    bool pin_ = false;
    std::uint64_t pin_edges_ = 0;
};

}  // namespace puckloop::avr
