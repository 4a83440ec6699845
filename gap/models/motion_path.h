#pragma once
// What a robot's motors did in each row of a run, and what of it reaches the floor: the parts of the motion
// model that know nothing of trackers.

#include "gap/models/wheel_curve.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace puckloop::gap {

struct Path {
    std::uint32_t run = 0;
    WheelCurve wheel[2], asked[2];
    std::vector<double> time, middle, load, incline;  ///< of the rows used
};

/// Steps told at one speed, without sign: a row has several such pieces where the command changes in it.
struct Pace {
    double steps, speed;
};

/// What a path's motors did in each of its rows, for one lateness of the tracker.
struct Driven {
    struct Wheel {
        std::vector<double> steps, asked;                  ///< steps made; steps told, without sign
        std::vector<std::uint32_t> first_jump, last_jump;  ///< changes of speed that may still cost way
    };
    Wheel wheel[2];
};

/// `late`: s that the tracker tells a pose late.
Driven driven_by(const Path& path, double late);

/// A wheel's steps told, in pieces of one speed.
struct Paced {
    std::vector<Pace> paces;
    std::vector<std::uint32_t> last;  ///< end of each row's pieces
};
Paced paced_by(const Path& path, std::size_t wheel, double late);

/// For each row: has neither wheel changed its speed in it or in the one before? What happens after a change
/// cannot be told from what the change itself does, and is not taken for a push.
std::vector<char> settled_rows(const Path& path, double late);

/// What tells the speed of a wheel: the command, where there is one; a counter's speeds are rounded.
const WheelCurve& pace_of(const Path& path, std::size_t wheel);

/// Share of a row's steps that a dead band (steps/s) lets through.
double let_through(const Paced& wheel, std::size_t row, double deadband);

/// Metres that changes of speed cost between two times (s): wheels follow no faster than mu g. On reversal
/// the wheel rolls on while its gear crosses the play (metres), and slides less. `metre`: of a step.
double slipped(std::span<const SpeedJump> jumps, double metre, double inverse_mu, double play, double from,
               double to);

/// A lost command leaves the wheel at its old speed until the host says the same again, in the next row: how
/// likely a row is off by one lost after a change, and by how many steps. `drop`: chance to lose one.
struct Loss {
    double chance = 0.0, steps = 0.0;
};
Loss lost(const std::vector<SpeedJump>& jumps, double drop, double from, double to);

}  // namespace puckloop::gap
