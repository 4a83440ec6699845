#pragma once
// Reset flags, sleep, clock prescaler, power reduction and vector placement: MCUSR, MCUCR, SMCR, CLKPR, PRR,
// OSCCAL. Source: data sheet 8272, "System Clock", "Power Management", "System Control and Reset",
// "Interrupts".
//
// Deviations
//  1. In the deeper sleep modes timers stand still (and their prescalers run on unseen); a transfer of a
//     USART, of the SPI, of the two-wire interface or of the ADC that is under way goes on.
//  2. The internal oscillators run at exactly 8 MHz and 128 kHz; OSCCAL is stored, a write of it is reported.
//  3. JTAG takes its pins and does nothing with them; OCDR is stored and reported.
//  4. The program begins in the clock of the reset: start-up delays (SUT) are those of waking up, and of a
//     supply that comes back (supply_reset.h).

#include "cosim/core/clock.h"
#include "emu/avr/core/core.h"
#include "emu/avr/devices/fuses.h"
#include "emu/avr/peripherals/surroundings.h"

#include <functional>

namespace puckloop::avr {

class SystemControl {
  public:
    SystemControl(const Surroundings& around, Core& core, cosim::ClockDomain& clock, const Fuses& fuses,
                  double oscillator_hertz);

    void reset(ResetCause cause);
    /// The fuse JTAGEN is programmed and MCUCR.JTD is not set: PC2 to PC5 are the debugger's.
    bool jtag() const;
    /// The brown-out detector was switched off for the sleep that lasts.
    bool brown_out_off() const { return brown_out_off_; }
    /// The timed sequence that moves the vectors (IVCE, IVSEL) is under way: no interrupt is taken.
    bool interrupts_held() const { return core_.cycle() < interrupts_held_until_; }
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
    /// The clock of timers and USARTs stands still, or runs again; that of timer 2's own only if
    /// `timer2_too`.
    std::function<void(bool stopped, bool timer2_too)> stop_clocks;
    /// jtag() may have changed.
    std::function<void()> jtag_changed;
    /// The pull-ups may have changed.
    std::function<void()> pull_ups_changed;
    /// Awake again with the brown-out detector, which had been off.
    std::function<void()> brown_out_on;
    /// The ADC begins a conversion because the CPU halts.
    std::function<void()> quiet_conversion;
    /// Called before and after the rate of the clock changes: what lasts a time keeps lasting it.
    std::function<void(bool changed)> rate_changes;

    template <class Archive>
    void state(Archive& archive) {
        archive(changeable_until_, vectors_changeable_until_, jtag_until_, jtag_wanted_, brown_out_from_,
                brown_out_until_, brown_out_off_, interrupts_held_until_);
    }

  private:
    void set_divider(unsigned select);
    double source_hertz() const;
    static std::uint8_t read_mcucr(void* owner, std::uint16_t address);
    static void write_reported(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    std::uint32_t brown_out_start_up(std::uint32_t clocks) const;
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
    Cycle jtag_until_ = 0;                ///< the second write of JTD counts
    bool jtag_wanted_ = false;
    Cycle brown_out_from_ = 0;   ///< BODS may be set up to here, BODSE having been
    Cycle brown_out_until_ = 0;  ///< BODS is set up to here
    bool brown_out_off_ = false;
    Cycle interrupts_held_until_ = 0;
};

}  // namespace puckloop::avr
