#pragma once
// Light whose change is known and has not shown yet: a program looks at its receivers far less often than
// light changes, so a change is put where it belongs when somebody looks, and the chip need not stop for it.

#include "cosim/core/time.h"
#include "emu/rab_board/signals.h"

#include <cstddef>
#include <vector>

namespace puckloop::rab {

class ArrivingLight {
  public:
    struct Change {
        cosim::Time time = 0;
        SignalId id = 0;
        double value = 0.0;
    };

    /// In time order.
    void add(const Change& change) { changes_.push_back(change); }
    bool none() const { return first_ == changes_.size(); }
    /// Takes every change at or before `now` off.
    template <class Use>
    void take(cosim::Time now, Use use) {
        while (!none() && changes_[first_].time <= now)
            use(changes_[first_++]);
        if (!none()) return;
        changes_.clear();
        first_ = 0;
    }
    /// The same, and all of it stays.
    template <class Use>
    void look(cosim::Time now, Use use) const {
        for (std::size_t i = first_; i < changes_.size() && changes_[i].time <= now; ++i)
            use(changes_[i]);
    }
    /// When the first demodulator changes after `now`; kNever: none does.
    cosim::Time next_pin(cosim::Time now) const {
        for (std::size_t i = first_; i < changes_.size(); ++i)
            if (changes_[i].id < kPeak && changes_[i].time > now) return changes_[i].time;
        return cosim::kNever;
    }

  private:
    std::vector<Change> changes_;
    std::size_t first_ = 0;  ///< that has not shown
};

}  // namespace puckloop::rab
