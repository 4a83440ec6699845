#pragma once
// What the clock models of both families share: the keys in front of OSCCON, and how a new rate is reported.

#include "cosim/core/clock.h"
#include "emu/dspic/peripherals/surroundings.h"

#include <cstdint>

namespace puckloop::dspic {

/// Two key bytes in successive instructions open a half of OSCCON for the next one.
struct OscconKeys {
    std::uint8_t first = 0;
    std::uint8_t second = 0;
    int seen = 0;
    Cycle last = 0;

    template <class Archive>
    void state(Archive& archive) {
        archive(seen, last);
    }

    /// A byte is written to the half at cycle `now`: true if it is the value that the keys let through.
    /// `cpu_cycle`: cycles in one of the CPU.
    bool opens(std::uint8_t value, Cycle now, Cycle cpu_cycle = 1) {
        constexpr Cycle kDistance = 2;  // the writes come from successive instructions
        const bool in_time = now - last <= kDistance * cpu_cycle;
        last = now;
        if (seen == 2 && in_time) {
            seen = 0;
            return true;
        }
        if (seen == 1 && in_time && value == second)
            seen = 2;
        else
            seen = value == first ? 1 : 0;
        return false;
    }
};
inline constexpr OscconKeys kHighKeys{0x78, 0x9A};
inline constexpr OscconKeys kLowKeys{0x46, 0x57};

/// The configuration words that choose the clock. `foscsel`: 33FJ only.
struct ClockConfiguration {
    std::uint16_t fosc = 0xFFFF;
    std::uint16_t foscsel = 0xFFFF;

    template <class Archive>
    void state(Archive& archive) {
        archive(fosc, foscsel);
    }
};

class ClockControl {
  public:
    virtual ~ClockControl() = default;

    virtual void configure(const ClockConfiguration& words) = 0;
    /// A reset; the registers themselves have been reset. Only power-on takes the clock that the words choose
    /// on parts that keep theirs over other resets.
    virtual void reset(bool power_on) = 0;

    /// The crystal does not swing any more. What runs from it goes on with the internal oscillator if the
    /// fail-safe monitor is on, CF set and the oscillator trap with it; false: the part stands still.
    virtual bool crystal_stopped(Cycle at) = 0;
    /// From what ends Sleep to the first instruction.
    virtual double wake_seconds() const = 0;

    /// 33FJ: called after each change of CLKDIV, resets included; may stay empty.
    void (*on_doze)(void* owner) = nullptr;
    /// Called after each change of the instruction rate.
    void (*on_rate)(void* owner, double hertz) = nullptr;
    void* on_rate_owner = nullptr;

  protected:
    /// What every wake-up from Sleep takes, the PLL's lock, and the monitor's wait: 30F data sheet, tables of
    /// the AC characteristics (TPOR, TLOCK, TFSCM), typical.
    static constexpr double kPowerOnSeconds = 10e-6, kLockSeconds30F = 20e-6, kMonitorSeconds = 100e-6;
    static constexpr double kStartupPeriods = 1024.0;  ///< of a crystal (OST)

    void change_rate(cosim::ClockDomain& clock, Cycle at, double hertz) const {
        if (hertz == clock.hertz()) return;
        clock.change_rate(at, hertz);
        if (on_rate) on_rate(on_rate_owner, hertz);
    }
};

}  // namespace puckloop::dspic
