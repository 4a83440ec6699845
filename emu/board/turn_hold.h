#pragma once
// A board that goes on beyond what its I2C bus may say, as long as it is the board's turn there
// (cosim/core/sampled_inputs.h), and ends where it has said something.

#include "cosim/core/time.h"

#include <algorithm>

namespace puckloop::board {

class TurnHold {
  public:
    /// The board is advanced in its turn; what it says may be answered from `answered` on.
    void begin(cosim::Time answered) { answered_ = answered; }
    void end() { answered_ = end_ = cosim::kNever; }
    /// The board says something with this stamp, after whatever was handed in by `now`. It is answered later
    /// than either.
    template <class Chip>
    void said(Chip& chip, cosim::Time stamp, cosim::Time now) {
        if (answered_ == cosim::kNever) return;
        end_ = std::min(end_, std::max({answered_, stamp + 1, now + 1}));
        chip.pause_at(end_);
    }
    /// The board is not to go beyond; kNever while it has said nothing.
    cosim::Time limit() const { return end_; }

  private:
    cosim::Time answered_ = cosim::kNever, end_ = cosim::kNever;
};

}  // namespace puckloop::board
