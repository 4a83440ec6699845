#pragma once
// A chip's clock domain: cycles to simulated time and back, exactly, with drift and rate changes.

#include "cosim/core/time.h"

#include <cstdint>
#include <vector>

namespace puckloop::cosim {

/// Cycle n of a domain starts at time_of(n). The mapping is exact integer arithmetic: no rounding
/// accumulates.
class ClockDomain {
  public:
    /// `hertz` > 0 is the nominal rate; `ppm` its error (+ is fast). The effective rate is kept to 1e-6 Hz.
    explicit ClockDomain(double hertz, double ppm = 0.0);

    /// Start of cycle `cycle`, rounded down to a picosecond; of any cycle, changes of rate in between or not.
    Time time_of(std::uint64_t cycle) const;
    /// First cycle that starts at or after `time`; times before the last change of rate give its first cycle.
    std::uint64_t first_cycle_at(Time time) const;
    /// From cycle `cycle` on the domain runs at `hertz` (PLL, clock switch); `ppm` of the crystal stays.
    void change_rate(std::uint64_t cycle, double hertz);
    /// From cycle `cycle` on its error is `ppm`; the nominal rate stays.
    void change_ppm(std::uint64_t cycle, double ppm);

    double hertz() const { return hertz_; }
    double ppm() const { return ppm_; }

    template <class Archive>
    void state(Archive& archive) {
        archive.bounded(hertz_, 1.0, 1e10);
        archive.bounded(ppm_, -1e5, 1e5);
        archive(present_);
        archive.grows(past_);
        if constexpr (Archive::kRaw) return;
        std::uint64_t before = 0;
        for (const Stretch& stretch : past_) {
            archive.check(stretch.cycle >= before, "stretches of the clock do not rise");
            before = stretch.cycle;
        }
        archive.check(present_.cycle >= before, "stretches of the clock do not rise");
        archive.check((past_.empty() ? present_ : past_.front()).cycle == 0,
                      "the clock does not begin with cycle 0");
    }

  private:
    /// A stretch of constant rate, from its first cycle to the next stretch.
    struct Stretch {
        std::uint64_t cycle = 0;
        Time time = 0;
        std::uint64_t microhertz = 0;
        Time time_of(std::uint64_t later_cycle) const;
        template <class Archive>
        void state(Archive& archive) {
            archive(cycle);
            archive.bounded(time, 0, kNever);
            archive.bounded(microhertz, 1'000'000, 10'000'000'000'000'000);
        }
    };
    std::uint64_t effective_microhertz(double hertz) const;

    double hertz_ = 0.0;
    double ppm_ = 0.0;
    Stretch present_;
    std::vector<Stretch> past_;
};

}  // namespace puckloop::cosim
