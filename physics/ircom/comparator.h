#pragma once
// The TAM's infra-red input: a phototransistor with one time constant, and a comparator behind it. Source:
// TAM fact sheet, section 2 (LM293, threshold 0.985 V).
//
// Deviations: no hysteresis, no offset, no daylight; the same time constant for rise and fall.

#include "cosim/core/time.h"

#include <cmath>

namespace puckloop::physics {

class IrcomComparator {
  public:
    /// `threshold` in counts, > 0; `time_constant` in seconds, > 0.
    explicit IrcomComparator(double threshold = 1.0, double time_constant = 1e-6)
        : threshold_(threshold), time_constant_(time_constant * 1e12) {}

    /// The output, as of what was seen last.
    bool high() const { return high_; }
    /// When it switches if the light stays as it is, or kNever.
    cosim::Time crossing() const { return crossing_; }
    /// It has switched at crossing().
    void cross() {
        high_ = !high_;
        crossing_ = cosim::kNever;
    }
    /// The light from `now` on; crossing() must not lie before `now`.
    void see(cosim::Time now, double light) {
        at_edge_ = voltage(now);
        edge_ = now;
        light_ = light;
        crossing_ = cosim::kNever;
        if (high_ == (light_ > threshold_)) return;
        const double way = (at_edge_ - light_) / (threshold_ - light_);
        const double wait = way > 1.0 ? time_constant_ * std::log(way) : 0.0;
        if (wait < 1e12) crossing_ = now + static_cast<cosim::Time>(std::llround(wait));
    }

    template <class Archive>
    void state(Archive& archive) {
        archive(at_edge_, light_, edge_, crossing_, high_);
    }

  private:
    double voltage(cosim::Time now) const {
        return light_ + (at_edge_ - light_) * std::exp(-static_cast<double>(now - edge_) / time_constant_);
    }

    double threshold_, time_constant_;  // ps
    double at_edge_ = 0.0, light_ = 0.0;
    cosim::Time edge_ = 0, crossing_ = cosim::kNever;
    bool high_ = false;
};

}  // namespace puckloop::physics
