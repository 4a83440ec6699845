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

    /// Where the speed of a wheel is read: the command, where there is one; a counter's speeds are rounded.
    const WheelCurve& paced(std::size_t w) const { return asked[w].empty() ? wheel[w] : asked[w]; }
};

/// Has neither wheel changed its speed in a row of `span` s after `before` or in the row before it? What
/// happens after a change cannot be parted from what the change itself does, and is not taken for a push.
bool settled(const Path& path, double before, double span);

/// Share of the steps commanded between two times (s) that a dead band (steps/s) lets through; `pacer` reads
/// `asked`.
double let_through(const WheelCurve& asked, CurveReader& pacer, double deadband, double from, double to);

/// Metres that changes of speed cost between two times (s): wheels follow no faster than mu g. On reversal
/// the wheel rolls on while its gear crosses the play (metres), and slides less. `metre`: of a step.
double slipped(const std::vector<SpeedJump>& jumps, double metre, double inverse_mu, double play, double from,
               double to);

/// A lost command leaves the wheel at its old speed until the host says the same again, in the next row: how
/// likely a row is off by one lost after a change, and by how many steps (more are positive). `drop`: chance
/// to lose one; `again`: to lose one after a lost one.
struct Loss {
    double chance = 0.0, steps = 0.0;
};
Loss lost(const std::vector<SpeedJump>& jumps, double drop, double again, double from, double to);

/// The heading that turns a tracker's steps into along and across: neither the tracker's, which is noisy and
/// makes the sums wander, nor the wheels', which a wrong parameter turns away, but the wheels' carried along
/// the tracker's.
///
/// Errors of measured headings. `above`: measured minus predicted, rad, a row each; `time`: s, ascending.
/// What `above` keeps for longer than `span` seconds is taken for the robot's own, the rest for the
/// tracker's. Over a row that turned the robot by itself (`kept`: below 1; empty: no row did) no more is
/// kept. Deviation: an average weighted by exp(-distance / span), not a smoother that knows the tails.
void heading_errors(std::span<const double> above, std::span<const double> time, double span,
                    std::span<const double> kept, std::vector<double>& errors);

/// What turns a robot beside its wheels, a row each: by `turn` (rad, standard deviation) with some chance,
/// and by a variance (rad squared) for sure. Empty: nothing does.
struct Turned {
    std::span<const double> chance, turn, variance;
};

/// How much of what was known of the heading each row leaves: all that is not turned, at most. The tracker's
/// noise is taken from the middle of the steps of `above`.
void kept_headings(std::span<const double> above, const Turned& turned, std::vector<double>& kept);

}  // namespace puckloop::gap
