#pragma once
// A free-running prescaler: it divides the clock whether a timer listens or not, so that a timer's first tick
// comes up to a whole period after the timer is started. Source: data sheet 8272, "Timer/Counter0, 1 and 3
// Prescalers".

#include "emu/avr/device.h"

namespace puckloop::avr {

class Prescaler {
  public:
    /// Ticks of the clock divided by `divider` in the clocks after `from`, up to and including `to`.
    Cycle ticks(Cycle from, Cycle to, Cycle divider) const {
        if (held_ && divider > 1) return 0;
        return (to - phase_) / divider - (from - phase_) / divider;
    }
    /// The clock of the `n`th tick after `from`, n >= 1.
    Cycle tick(Cycle from, Cycle n, Cycle divider) const {
        if (held_ && divider > 1) return kNoCycle;
        return phase_ + ((from - phase_) / divider + n) * divider;
    }
    /// Clocks at `now` since the last tick.
    Cycle position(Cycle now, Cycle divider) const {
        return held_ && divider > 1 ? 0 : (now - phase_) % divider;
    }
    bool held() const { return held_; }
    /// The clock that it divides stands still (sleep): its timers do, whatever they divide by.
    bool stopped() const { return stopped_; }
    void stop(bool on) { stopped_ = on; }
    /// The counter is 0 in this clock; `held`: it stays there.
    void reset(Cycle now, bool held) {
        phase_ = now;
        held_ = held;
    }

    template <class Archive>
    void state(Archive& archive) {
        archive(phase_, held_, stopped_);
    }

  private:
    Cycle phase_ = 0;
    bool held_ = false;
    bool stopped_ = false;
};

}  // namespace puckloop::avr
