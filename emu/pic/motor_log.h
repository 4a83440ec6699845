#pragma once
// From the steps of one motor to what a log has of it: when it started, turned round and stopped.

#include "cosim/core/time.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace puckloop::pic {

class MotorLog {
  public:
    using Line = std::pair<cosim::Time, std::string>;

    explicit MotorLog(std::string_view side) : side_(side) {}

    /// The counter stands at `steps` from `now` on; a line if the motor started or turned round.
    std::optional<Line> step(std::int64_t steps, cosim::Time now);
    /// A line once the motor has stood for kStill before `now`; to be asked before each step() as well.
    std::optional<Line> still(cosim::Time now);

    /// Longer than the interval of the slowest steps that a program of use makes.
    static constexpr cosim::Time kStill = cosim::kSecond / 4;

    template <class Archive>
    void state(Archive& archive) {
        archive(steps_);
        archive.bounded(last_, 0, cosim::kNever);
        archive.bounded(direction_, -1, 1);
    }

  private:
    std::string_view side_;
    std::int64_t steps_ = 0;
    cosim::Time last_ = 0;
    int direction_ = 0;  // 0 still
};

}  // namespace puckloop::pic
