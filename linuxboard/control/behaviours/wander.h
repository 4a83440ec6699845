#pragma once
// Wander with obstacle avoidance: straight on, and turn away from what the proximity ring sees.

#include "linuxboard/control/behaviours/behaviour.h"

namespace puckloop::control {

/// Proximity without each sensor's own offset, which is learnt as the smallest value seen.
class ProximityBaseline {
  public:
    std::array<double, 8> above_offset(const std::array<double, 8>& proximity);

  private:
    std::array<double, 8> offset_{};
    bool learnt_ = false;
};

class Wander : public Behaviour {
  public:
    /// Turns differ in length by up to `turn_spread` s, so that the robot does not shuttle.
    explicit Wander(double turn_spread = 0.8) : turn_spread_(turn_spread) {}
    Actuators step(const Sensors& sensors, double t) override;
    /// True while it turns away from an obstacle.
    bool avoiding() const { return turning_ != 0; }
    /// Proximity of the last step without the sensors' offsets.
    const std::array<double, 8>& above_offset() const { return above_; }

  private:
    ProximityBaseline baseline_;
    std::array<double, 8> above_{};
    double turn_spread_;
    int turning_ = 0;           // -1 clockwise, +1 counter-clockwise, 0 not
    double turn_at_least_ = 0;  // time until which a begun turn goes on
    unsigned turns_ = 0;
};

}  // namespace puckloop::control
