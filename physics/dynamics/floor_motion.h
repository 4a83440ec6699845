#pragma once
// What makes a robot go elsewhere than its wheels say, as one idea: the floor moves under it. Scrub and creep
// move the floor under each wheel by a share of what the wheel rolls, and friction hands it on; drift and
// pushes move all of the floor under the robot, which goes along until it meets something upright. The
// formulas are those of the motion effects 4, 6, 13, 14 (docs/gap.md).
//
// Deviations: 1. slope_creep goes by the tilt along the nose, as its formula states: driven backwards down a
// slope a robot loses the share that it loses driven forwards up it; a tyre that creeps under a force would
// gain. 2. A push takes the robot along for 50 ms, it does not hit or topple. 3. One push at a time: one that
// falls due during another follows it. 4. Creep costs all of the way at most.

#include "base/random.h"
#include "physics/description/parameters.h"

#include <array>

namespace puckloop::physics {

/// Velocity of the floor as it is under one robot.
struct FloorVelocity {
    std::array<double, 2> forward{};      ///< m/s along the left, right wheel, under that wheel only
    double x = 0.0, y = 0.0, turn = 0.0;  ///< m/s in the world's axes, rad/s about the axle's middle: of all
};

/// What the robot does while the floor's motion is asked for.
struct Rolling {
    std::array<double, 2> wheel{};  ///< m/s that the left, right tyre rolls
    double heading = 0.0;
    bool driven = false;   ///< steps come to one of the motors
    double seconds = 0.0;  ///< at the end of the step
};

class FloorMotion {
  public:
    /// `pushes` decides when and where to (only drawn from when push.rate > 0).
    FloorMotion(const Parameters& parameters, RandomStream pushes);

    /// All but the pushes, which stay as they were.
    void set_parameters(const Parameters& parameters);
    /// Nothing of this is asked for: the floor stands still.
    bool still() const { return still_; }
    /// Of the step of `step_seconds` that ends at `now.seconds`; once a step.
    FloorVelocity velocity(const Rolling& now, double step_seconds);
    /// Pushes begun so far, and where they took the robot in all (m, m, rad).
    int pushes() const { return pushes_; }
    const std::array<double, 3>& pushed() const { return pushed_; }

  private:
    double creep(double heading) const;
    void slide(std::array<double, 2> wheel, double share, FloorVelocity& floor) const;
    void push(double seconds, double step_seconds, FloorVelocity& floor);
    void begin_push(double seconds);

    BodyParameters body_{};
    PushParameters push_;
    double rise_x_, rise_y_;  // sine of the slope towards +x, +y
    RandomStream chance_;
    bool still_ = true;
    double next_push_ = 0.0, begun_ = -1.0;    // s
    std::array<double, 3> goal_{}, pushed_{};  // m, m, rad: of the push under way, of all
    int pushes_ = 0;
};

}  // namespace puckloop::physics
