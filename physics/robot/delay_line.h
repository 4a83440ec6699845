#pragma once
// Values as they were a while ago.

#include "physics/dynamics/dynamics.h"

#include <array>
#include <cmath>
#include <vector>

namespace puckloop::physics {

/// Fed once a physics step; between two steps a straight line. Before it has run full, the first value.
template <std::size_t N>
class DelayLine {
  public:
    using Values = std::array<double, N>;

    /// `seconds` >= 0. With 0 nothing is kept, and what comes in goes out.
    explicit DelayLine(double seconds)
        : whole_(static_cast<std::size_t>(seconds / kStepSeconds)),
          rest_(seconds / kStepSeconds - static_cast<double>(whole_)) {
        if (seconds > 0.0) kept_.resize(whole_ + 2);
    }

    bool delays() const { return !kept_.empty(); }

    Values next(const Values& now) {
        if (!delays()) return now;
        if (!begun_) kept_.assign(kept_.size(), now);
        begun_ = true;
        newest_ = after(newest_);
        kept_[newest_] = now;
        const Values& younger = kept_[newest_ >= whole_ ? newest_ - whole_ : newest_ + kept_.size() - whole_];
        const Values& older = kept_[after(newest_)];
        Values then{};
        for (std::size_t i = 0; i < N; ++i)
            then[i] = younger[i] + rest_ * (older[i] - younger[i]);
        return then;
    }

  private:
    std::size_t after(std::size_t index) const { return index + 1 == kept_.size() ? 0 : index + 1; }

    std::size_t whole_;  // steps
    double rest_;        // of a step
    std::vector<Values> kept_;
    std::size_t newest_ = 0;
    bool begun_ = false;
};

}  // namespace puckloop::physics
