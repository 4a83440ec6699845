#pragma once
// Reset flags, sleep, clock prescaler, power reduction and vector placement: MCUSR, MCUCR, SMCR, CLKPR, PRR,
// OSCCAL. Source: data sheet 8272, "System Clock", "Power Management", "System Control and Reset",
// "Interrupts".
//
// Deviations
//  1. In the deeper sleep modes timers stand still (and their prescalers run on unseen); a transfer of a
//  USART, of
//     the SPI, of the two-wire interface or of the ADC that is under way goes on.
//  2. OSCCAL is stored; JTAG (MCUCR.JTD, OCDR) and the brown-out switch (BODS) have no effect.

#include "cosim/core/clock.h"
#include "emu/avr/core/core.h"
#include "emu/avr/fuses.h"
#include "emu/avr/peripherals/surroundings.h"

#include <functional>

namespace puckloop::avr {

class SystemControl {
  public:
    SystemControl(const Surroundings& around, Core& core, cosim::ClockDomain& clock, const Fuses& fuses,
                  double oscillator_hertz);

    void reset(ResetCause cause);
    /// SLEEP.
    void sleep();
    void wake();
    /// Word address of vector 0, and of the reset vector.
    std::uint16_t vector_base() const;
    std::uint16_t reset_pc() const;
    /// First word of the boot section.
    std::uint32_t boot_start() const;

    /// Called before and after PRRn changes: modules bring themselves up to date.
    std::function<void()> synchronise;
    /// The clock of timers and USARTs stands still, or runs again.
    std::function<void(bool stopped)> stop_clocks;

    template <class Archive>
    void state(Archive& archive) {
        archive(changeable_until_, vectors_changeable_until_);
    }

  private:
    void set_divider(unsigned select);
    std::uint32_t start_up_clocks() const;
    static void write_flags(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void write_mcucr(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void write_prescaler(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void write_power(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);

    Surroundings around_;
    Core& core_;
    cosim::ClockDomain& clock_;
    const Fuses& fuses_;
    double oscillator_hertz_;
    Cycle changeable_until_ = 0;          ///< CLKPR
    Cycle vectors_changeable_until_ = 0;  ///< IVSEL
};

}  // namespace puckloop::avr
