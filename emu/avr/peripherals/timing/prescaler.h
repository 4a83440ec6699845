#pragma once
// A free-running prescaler: it divides the clock whether a timer listens or not, so that a timer's first tick
// comes up to a whole period after the timer is started. Source: data sheet 8272, "Timer/Counter0, 1 and 3
// Prescalers", "Timer/Counter Prescaler" of timer 2.

#include "emu/avr/peripherals/timing/watch_clock.h"

namespace puckloop::avr {

class Prescaler {
  public:
    /// `watch`: what it may divide instead of the CPU's clock; null: nothing.
    explicit Prescaler(const WatchClock* watch = nullptr) : watch_(watch) {}

    /// Ticks of the clock divided by `divider` in the clocks after `from`, up to and including `to`.
    Cycle ticks(Cycle from, Cycle to, Cycle divider) const {
        if (!plain_) {
            if (held_ && divider > 1) return 0;
            if (asynchronous_) {
                from = watch_->edges(from);
                to = watch_->edges(to);
            }
        }
        return (to - phase_) / divider - (from - phase_) / divider;
    }
    /// The clock of the `n`th tick after `from`, n >= 1; kNoCycle if it is not known.
    Cycle tick(Cycle from, Cycle n, Cycle divider) const {
        if (!plain_ && held_ && divider > 1) return kNoCycle;
        if (!plain_ && asynchronous_)
            return watch_->edge(phase_ + ((watch_->edges(from) - phase_) / divider + n) * divider);
        return phase_ + ((from - phase_) / divider + n) * divider;
    }
    /// Of a watch clock: the edge behind `edges` of them is a tick.
    bool ticks_of_edges(std::uint64_t edges, Cycle divider) const {
        if (held_ && divider > 1) return false;
        return (edges + 1 - phase_) % divider == 0;
    }
    /// Clocks at `now` since the last tick; not of a watch clock.
    Cycle position(Cycle now, Cycle divider) const {
        return held_ && divider > 1 ? 0 : (now - phase_) % divider;
    }
    bool held() const { return held_; }
    /// The clock that it divides stands still (sleep): its timers do, whatever they divide by.
    bool stopped() const { return stopped_; }
    void stop(bool on) { stopped_ = on; }
    /// The counter is 0 in this clock; `held`: it stays there.
    void reset(Cycle now, bool held) {
        phase_ = asynchronous_ ? watch_->edges(now) : now;
        held_ = held;
        plain_ = !held_ && !asynchronous_;
    }
    /// It divides the watch clock (ASSR.AS2), or the CPU's.
    bool asynchronous() const { return asynchronous_; }
    void use_watch(bool on, Cycle now) {
        asynchronous_ = on;
        reset(now, held_);
    }

    template <class Archive>
    void state(Archive& archive) {
        archive(phase_, held_, stopped_, asynchronous_);
        archive.check(!asynchronous_ || watch_, "a prescaler without a watch clock");
        if constexpr (Archive::kLoads) plain_ = !held_ && !asynchronous_;
    }

  private:
    const WatchClock* watch_;
    Cycle phase_ = 0;
    bool held_ = false;
    bool stopped_ = false;
    bool asynchronous_ = false;
    bool plain_ = true;  ///< neither held nor asynchronous
};

}  // namespace puckloop::avr
