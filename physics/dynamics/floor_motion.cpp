#include "physics/dynamics/floor_motion.h"

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {

constexpr double kPushSeconds = 0.05;  // a knock: within a tracker's row

/// Share of a push that is done at `part` of its time: evenly faster, then evenly slower.
double done(double part) {
    const double u = std::clamp(part, 0.0, 1.0);
    return u < 0.5 ? 2 * u * u : 1 - 2 * (1 - u) * (1 - u);
}

}  // namespace

FloorMotion::FloorMotion(const Parameters& parameters, RandomStream pushes)
    : push_(parameters.push),
      rise_x_(std::sin(parameters.world.slope_x)),
      rise_y_(std::sin(parameters.world.slope_y)),
      chance_(pushes) {
    set_parameters(parameters);
    if (push_.rate > 0.0) next_push_ = -std::log(1 - chance_.uniform()) / push_.rate;
}

void FloorMotion::set_parameters(const Parameters& parameters) {
    body_ = parameters.robot;
    const bool creeps = body_.load_creep * body_.load != 0.0 ||
                        (body_.slope_creep != 0.0 && (rise_x_ != 0.0 || rise_y_ != 0.0));
    still_ = body_.turn_scrub == 0.0 && !creeps && body_.drift_x == 0.0 && body_.drift_y == 0.0 &&
             push_.rate == 0.0;
}

FloorVelocity FloorMotion::velocity(const Rolling& now, double step_seconds) {
    FloorVelocity floor;
    slide(now.wheel, creep(now.heading), floor);
    if (now.driven) {
        floor.x = body_.drift_x;
        floor.y = body_.drift_y;
    }
    if (push_.rate > 0.0) push(now.seconds, step_seconds, floor);
    return floor;
}

/// Share of the way that is lost: all of it at most, or the floor would drive the wheel.
double FloorMotion::creep(double heading) const {
    double lost = body_.load_creep * body_.load;
    if (body_.slope_creep != 0.0)
        lost += body_.slope_creep *
                std::asin(std::clamp(rise_x_ * std::cos(heading) + rise_y_ * std::sin(heading), -1.0, 1.0));
    return std::min(lost, 1.0);
}

/// Wheels that roll at different speeds turn the robot as if the axle were longer by turn_scrub times the
/// turn's share of the motion.
void FloorMotion::slide(std::array<double, 2> wheel, double lost, FloorVelocity& floor) const {
    const double left = wheel[0] * (1 - lost), right = wheel[1] * (1 - lost);
    const double way = std::abs(left + right) / 2, twist = std::abs(right - left) / 2;
    double scrubbed = 0.0;  // m/s, of each wheel
    if (body_.turn_scrub != 0.0 && twist > 0.0) {
        const double longer = body_.turn_scrub * twist / (way + twist);
        scrubbed = (right - left) / 2 * longer / (1 + longer);
    }
    floor.forward = {-wheel[0] * lost + scrubbed, -wheel[1] * lost - scrubbed};
}

void FloorMotion::push(double seconds, double step_seconds, FloorVelocity& floor) {
    if (seconds >= next_push_ && seconds >= begun_ + kPushSeconds) begin_push(seconds - step_seconds);
    const double share =
        done((seconds - begun_) / kPushSeconds) - done((seconds - step_seconds - begun_) / kPushSeconds);
    floor.x += goal_[0] * share / step_seconds;
    floor.y += goal_[1] * share / step_seconds;
    floor.turn += goal_[2] * share / step_seconds;
}

void FloorMotion::begin_push(double seconds) {
    next_push_ -= std::log(1 - chance_.uniform()) / push_.rate;
    begun_ = seconds;
    goal_ = {push_.size * chance_.normal(), push_.size * chance_.normal(), push_.turn * chance_.normal()};
    for (std::size_t i = 0; i < goal_.size(); ++i)
        pushed_[i] += goal_[i];
    ++pushes_;
}

}  // namespace puckloop::physics
