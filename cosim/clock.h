#pragma once
// A chip's clock domain: cycles to simulated time and back, exactly, with drift and rate changes.

#include "cosim/time.h"

#include <cstdint>

namespace puckloop::cosim {

/// Cycle n of a domain starts at time_of(n). The mapping is exact integer arithmetic: no rounding
/// accumulates.
class ClockDomain {
  public:
    /// `hertz` > 0 is the nominal rate; `ppm` its error (+ is fast). The effective rate is kept to 1e-6 Hz.
    explicit ClockDomain(double hertz, double ppm = 0.0);

    /// Start of cycle `cycle`, rounded down to a picosecond. Cycles before the last change of rate are not
    /// known.
    Time time_of(std::uint64_t cycle) const;
    /// First cycle that starts at or after `time`.
    std::uint64_t first_cycle_at(Time time) const;
    /// From cycle `cycle` on the domain runs at `hertz` (PLL, clock switch); `ppm` of the crystal stays.
    void change_rate(std::uint64_t cycle, double hertz);

    double hertz() const { return hertz_; }
    double ppm() const { return ppm_; }

  private:
    void set_rate(double hertz);

    double hertz_ = 0.0;
    double ppm_ = 0.0;
    std::uint64_t microhertz_ = 0;
    std::uint64_t base_cycle_ = 0;
    Time base_time_ = 0;
};

}  // namespace puckloop::cosim
