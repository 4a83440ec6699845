#pragma once
// The watchdog timer with its own 128 kHz oscillator: interrupt mode, reset mode and both. Source: data sheet
// 8272, "Watchdog Timer".
//
// Deviations
//  1. The oscillator runs at exactly 128 kHz, whatever the supply and the temperature.

#include "cosim/core/clock.h"
#include "emu/avr/core/core.h"
#include "emu/avr/peripherals/surroundings.h"

namespace puckloop::avr {

class Watchdog {
  public:
    Watchdog(const Surroundings& around, Core& core, const cosim::ClockDomain& clock);

    /// `always_on`: fuse WDTON. MCUSR.WDRF keeps it on as well.
    void reset(bool always_on);
    /// The chip is held in reset.
    void stop() { around_.events.cancel(slot_); }
    /// Before and after a change of the CPU's clock, which is not the watchdog's.
    void rate_changes(bool changed);
    /// WDR.
    void restart();

    template <class Archive>
    void state(Archive& archive) {
        archive(changeable_until_, always_on_);
    }

  private:
    std::uint8_t& control() const { return around_.io.raw(0x60); }
    /// In cycles, as this value of WDTCSR has it.
    Cycle period(std::uint8_t control) const;
    void plan(Cycle from);
    void change_period(std::uint8_t old, Cycle now);
    void update_request();
    static void write_control(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void due(void* owner, Cycle cycle);
    static void acknowledge(void* owner, int vector);

    Surroundings around_;
    Core& core_;
    const cosim::ClockDomain& clock_;
    Cycle changeable_until_ = 0;  ///< of the timed sequence
    bool always_on_ = false;
    cosim::Time kept_ = 0;  ///< when the event is due, while the clock's rate changes
    EventQueue::Slot slot_;
};

}  // namespace puckloop::avr
