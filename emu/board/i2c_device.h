#pragma once
// When a board that is a device of an I2C bus answers at the earliest.

#include "cosim/core/message.h"
#include "cosim/core/time.h"

#include <algorithm>
#include <cmath>

namespace puckloop::board {

/// Eight clocks after a phase began: of a bus whose master has this clock at most.
class I2cDeviceTimes {
  public:
    explicit I2cDeviceTimes(double fastest_hertz)
        : fastest_period_(
              static_cast<cosim::Time>(std::llround(static_cast<double>(cosim::kSecond) / fastest_hertz))) {}

    cosim::Time fastest_period() const { return fastest_period_; }
    /// From a phase that comes in to its answer. The bus hands a phase on half a clock late at most.
    cosim::Time lookahead() const { return kClocksToAnswer * fastest_period_ - fastest_period_ / 2; }
    /// The phase, moved where a bus that passes it on late, or a master faster than the fastest, would break
    /// that promise.
    cosim::I2cPhase held(cosim::I2cPhase phase, cosim::Time now) const {
        const bool answered = phase.kind != cosim::I2cPhaseKind::Acknowledge || phase.ack != 0;
        if (phase.kind == cosim::I2cPhaseKind::Stop || !answered) return phase;
        phase.clock_period = std::max(phase.clock_period, fastest_period_);
        phase.start = std::max(phase.start, now + lookahead() - kClocksToAnswer * phase.clock_period);
        return phase;
    }

    static constexpr cosim::Time kClocksToAnswer = 8;

  private:
    cosim::Time fastest_period_;
};

}  // namespace puckloop::board
