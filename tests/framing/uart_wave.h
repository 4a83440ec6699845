#pragma once
// A line's levels painted onto time by what is meant to happen to it, apart from the product's own frames and
// faults, to judge both.

#include "cosim/core/time.h"
#include "tests/framing/uart_line.h"

#include <map>

namespace puckloop::framing {

class Wave {
  public:
    bool level(cosim::Time time) const { return std::prev(levels_.upper_bound(time))->second; }
    void paint(cosim::Time begin, cosim::Time end, bool high) {
        cut(begin);
        cut(end);
        for (auto it = levels_.find(begin); it->first < end; ++it)
            it->second = high;
    }
    void flip(cosim::Time begin, cosim::Time end) {
        cut(begin);
        cut(end);
        for (auto it = levels_.find(begin); it->first < end; ++it)
            it->second = !it->second;
    }
    /// Start bit, data, parity as the format has it; the stop bits are high.
    void word(const Format& format, std::uint16_t data, cosim::Time start, cosim::Time bit) {
        paint(start, start + bit, false);
        for (int i = 0; i < format.data_bits; ++i)
            paint(start + bit * (1 + i), start + bit * (2 + i), data >> i & 1);
        const cosim::Time behind = start + bit * (1 + format.data_bits);
        if (format.parity) paint(behind, behind + bit, parity_bit(data, format.parity));
    }
    /// The next instant after `time` at which the level becomes the other one; cosim::kNever if none does.
    cosim::Time next_edge(cosim::Time time) const {
        const bool now = level(time);
        for (auto it = levels_.upper_bound(time); it != levels_.end(); ++it)
            if (it->second != now) return it->first;
        return cosim::kNever;
    }

  private:
    void cut(cosim::Time time) { levels_.emplace(time, level(time)); }
    std::map<cosim::Time, bool> levels_{{-1, true}};  ///< level from then on
};

}  // namespace puckloop::framing
