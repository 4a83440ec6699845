#pragma once
// What one phototransistor shows of the infra-red light of others: it follows with one time constant.
//
// Deviations: 1. The same time constant for rise and fall, however bright the light.

#include "emu/dspic/machine/event_queue.h"

#include <cmath>

namespace puckloop::pic {

class LightInput {
  public:
    /// `time_constant` in cycles, > 0.
    explicit LightInput(double time_constant) : time_constant_(time_constant) {}

    /// The light from `now` on, counts, 0 or more.
    void set(double counts, dspic::Cycle now) {
        at_edge_ = counts_at(now);
        edge_ = now;
        light_ = counts;
        dark_ = counts == 0.0 && at_edge_ == 0.0;
    }
    /// Counts that it shows at `now`; for a cycle before the last change, what it showed at that change.
    double counts_at(dspic::Cycle now) const {
        if (dark_ || now <= edge_) return at_edge_;
        const double age = static_cast<double>(now - edge_) / time_constant_;
        return age > kSettled ? light_ : light_ + (at_edge_ - light_) * std::exp(-age);
    }

    /// From here on counts_at() stays the same until set().
    dspic::Cycle settled_from() const {
        return edge_ + static_cast<dspic::Cycle>(kSettled * time_constant_) + 2;
    }

    template <class Archive>
    void state(Archive& archive) {
        archive.bounded(at_edge_, 0.0, 1e9);
        archive.bounded(light_, 0.0, 1e9);
        archive(edge_, dark_);
    }

  private:
    static constexpr double kSettled = 40.0;  // time constants

    double time_constant_;
    double at_edge_ = 0.0, light_ = 0.0;
    dspic::Cycle edge_ = 0;
    bool dark_ = true;
};

}  // namespace puckloop::pic
