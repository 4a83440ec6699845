#pragma once
// From the emulated motor's step counts to the angle a wheel is asked to take. Sources: e-puck motor facts
// (four-phase stepper, 1000 steps a turn).
//
// Deviations: 1. between two steps the rotor is taken to turn evenly (a real one swings into each step);
// the wheel thus runs one step interval behind the coils, and ends exactly on the last step. 2. Pull-out is a
// threshold on the lag, not a torque curve. 3. Below robot.deadband the rotor leans one step towards where it
// is asked to and no further, so that a drive's first step is not lost.

#include "base/random.h"
#include "physics/description/parameters.h"

namespace puckloop::physics {

class WheelDrive {
  public:
    /// `losses` decides which steps a fast motor loses (only drawn from when robot.step_loss_speed > 0).
    WheelDrive(const BodyParameters& parameters, RandomStream losses);

    /// All but steps_per_turn, which stays.
    void set_parameters(const BodyParameters& parameters) { parameters_ = parameters; }

    /// The firmware's counter stood at `steps` from `seconds` on; calls in order of time.
    void step_to(double steps, double seconds);

    /// Angle in radians behind the gear at `seconds`, which never goes back and is not before the last step.
    double angle(double seconds);

    /// Takes where the wheel really is (radians): a rotor too far ahead of it falls back by whole pole pairs.
    /// Returns by how many radians (signed; mostly 0).
    double pull_out(double wheel_angle);

    /// Did a step come within the smoothing limit before `seconds`?
    bool running(double seconds) const;
    /// Do steps still come at `seconds`? A single step counts until the next one is overdue.
    bool driven(double seconds) const;
    /// s after a step for which the wheel counts as driven, where the one before it came `interval` s
    /// earlier.
    static double driven_for(double interval, const BodyParameters& parameters);
    /// Rate of the steps, steps/s without sign; falls with the time since the last one, to 0 after 0.1 s.
    double speed(double seconds) const;
    double steps() const { return steps_; }
    /// Steps lost so far, signed: pulled out, too fast or too slow.
    double lost() const { return lost_; }

  private:
    double rotor(double seconds) const;
    void lose_at_speed(double change, double interval);
    void hold_if_slow(double change, double interval);

    BodyParameters parameters_;
    RandomStream losses_;
    double radians_per_step_;
    double steps_ = 0.0;       // the firmware's counter
    double lost_ = 0.0;        // counter minus where the rotor is going
    double from_ = 0.0;        // rotor position in steps when the last step came
    double begun_ = 0.0;       // s, when it came
    double duration_ = 0.0;    // s, until the rotor has arrived
    double to_lose_ = 0.0;     // steps still missing of groups that are being lost, signed
    double last_step_ = -1e9;  // s
    double interval_ = 0.0;    // s, between the last two steps
    double change_ = 0.0;      // steps, the last one
    double held_ = 0.0;        // last step if it was too slow: no more than this of slow steps is followed
    double geared_ = 0.0;      // rad, behind the backlash
};

}  // namespace puckloop::physics
