#pragma once
// The infra-red emitters of one pulse line and what the phototransistors follow of them.
// Source: e-puck fact sheet 5.1: rise and fall of tens of microseconds, settled 300 us after the edge.
//
// Deviations:
// 1. One exponential with one time constant for emitter and receiver together, the same for rise and fall.

#include "emu/dspic/machine/event_queue.h"

#include <cmath>

namespace puckloop::pic {

class Emitter {
  public:
    /// `time_constant` in cycles, > 0.
    explicit Emitter(double time_constant) : time_constant_(time_constant) {}

    void set(bool on, dspic::Cycle now);
    bool on() const { return on_; }
    /// Share of the reflected light that the receiver shows at `now`, 0..1.
    double intensity(dspic::Cycle now) const {
        const double target = on_ ? 1.0 : 0.0;
        const double age = now > edge_ ? static_cast<double>(now - edge_) : 0.0;
        if (age > kSettled * time_constant_) return target;
        return target + (at_edge_ - target) * std::exp(-age / time_constant_);
    }

    /// From here on intensity() stays the same until set().
    dspic::Cycle settled_from() const { return edge_ + settling(time_constant_); }
    static dspic::Cycle settling(double time_constant) {
        return static_cast<dspic::Cycle>(kSettled * time_constant) + 2;
    }

    template <class Archive>
    void state(Archive& archive) {
        archive.bounded(at_edge_, 0.0, 1.0);
        archive(edge_, on_);
    }

  private:
    /// Time constants; less than 2e-35 is left, which moves no ADC code.
    static constexpr double kSettled = 80.0;

    double time_constant_;
    double at_edge_ = 0.0;
    dspic::Cycle edge_ = 0;
    bool on_ = false;
};

}  // namespace puckloop::pic
