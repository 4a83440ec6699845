#include "emu/pic/motor_log.h"

#include <fmt/format.h>

namespace puckloop::pic {

std::optional<MotorLog::Line> MotorLog::step(std::int64_t steps, cosim::Time now) {
    const int direction = steps > steps_ ? 1 : -1;
    const bool same = direction == direction_;
    const std::int64_t from = steps_;
    steps_ = steps;
    last_ = now;
    direction_ = direction;
    if (same) return std::nullopt;
    return Line{
        now, fmt::format("{} motor runs {} from step {}", side_, direction > 0 ? "forward" : "back", from)};
}

std::optional<MotorLog::Line> MotorLog::still(cosim::Time now) {
    if (direction_ == 0 || now - last_ <= kStill) return std::nullopt;
    direction_ = 0;
    return Line{last_ + kStill, fmt::format("{} motor still since {:.6f} s, at step {}", side_,
                                            cosim::to_seconds(last_), steps_)};
}

}  // namespace puckloop::pic
