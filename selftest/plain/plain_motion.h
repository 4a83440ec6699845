#pragma once
// A differential-drive robot reduced to its wheels, stepped at 1 ms, and the tracker that watches it. Written
// from the effects sheet's section A; with every knob at rest it is what the simulator assumes: wheels of
// 20.5 mm, 53 mm apart, that follow the motors' steps as far as a friction of 0.7 lets them.

#include "base/random.h"

#include <array>
#include <functional>
#include <vector>

namespace puckloop::gap::selftest {

/// What may be wrong. Numbers of the effects sheet in brackets.
struct MotionKnobs {
    double radius_scale = 1.0;              // [1] both wheels
    double mismatch = 0.0;                  // [2] (rR - rL) / (rR + rL)
    double axle_scale = 1.0;                // [3] L / L0
    double scrub = 0.0;                     // [4] L_eff = L (1 + c |w| / (|v| + |w| L / 2))
    double friction = 0.7;                  // [5] mu
    double creep = 0.0;                     // [6] share of travel lost a kg of load
    double loss_speed = 0.0;                // [7] steps/s, 0 = never
    double loss_width = 50.0;               // [7] steps/s
    double deadband = 0.0;                  // [9] steps/s
    double backlash = 0.0;                  // [10] m at the rim
    double latency = 0.0;                   // [11] s
    double latency_jitter = 0.0;            // [11] s
    double drop = 0.0;                      // [12] probability that a command is lost
    double pull_x = 0.0, pull_y = 0.0;      // [13] m/s in the world while driving
    double push_rate = 0.0;                 // [14] 1/s
    double push_size = 0.0;                 // [14] m
    double marker_x = 0.0, marker_y = 0.0;  // [15] m in the robot's frame
    double tracker_delay = 0.0;             // [16] s
    double heading_drift = 0.0;             // [17] rad/s in what is measured
    double eccentricity = 0.0;              // unknown: radius varies over a wheel turn
    double lens = 0.0;                      // unknown: tracker stretches with distance squared, 1/m2
    double patch = 0.0;                     // unknown: share of travel lost where x > 0.15 m
    double thrust = 0.0;  // unknown: heading kicked, rad per change of both wheels' sign sum
};

/// A command holds from `begin` (s) until the next one; steps/s.
struct WheelCommand {
    double begin, left, right;
};

struct MotionScript {
    double seconds = 20.0;
    double heading = 0.0;  ///< at the start
    double load = 0.0;     ///< kg carried
    std::vector<WheelCommand> commands;
};

/// One row each `period`, as the laboratory would log it, without noise.
struct MotionRow {
    double t, cmd_left, cmd_right, steps_left, steps_right, x, y, theta;
};

/// `chance` feeds lost commands, jitter and pushes only.
std::vector<MotionRow> drive(const MotionKnobs& knobs, const MotionScript& script, double period,
                             RandomStream chance);

/// The speed (steps/s) that the original firmware's 0.1 ms agenda makes of a command.
double agenda_speed(double command);

}  // namespace puckloop::gap::selftest
