#pragma once
// Is this data what it says it is? Looked at before anything is fitted: what cannot be used throws
// InputError, what can be used with care becomes a caution.

#include "gap/data/experiment.h"

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::gap {

/// All checks. May drop rows that no analysis can use (all truth missing), with a caution.
/// Every check is made, and what is wrong goes to `problems`; those that need sound columns only where all
/// are.
void check(Experiment& experiment, Problems& problems);

/// A column of all runs, one behind the other; NaN in the rows of runs without it.
std::vector<double> pooled(const Experiment& experiment, std::string_view column);

/// [nominal]: what no robot can have is refused; a caution for what is far from anything that the simulator's
/// robot can have, mostly a number in another unit.
void check_nominal(Experiment& experiment);
/// What needs to know what a kind of experiment is: swapped columns, wrong units that stay plausible.
void check_kind(Experiment& experiment);
/// Of a motion experiment: units, sides, headings, counters.
void check_motion(Experiment& experiment);
/// A caution for each run in which the robot went without its wheels, with the rows.
void check_carried(Experiment& experiment);
/// m of way for a step of the left wheel, by the nominal numbers.
double metres_per_step(const Experiment& experiment);

/// Steps of the left and right wheel from the row before to this (row >= 1) of a motion run, by counters or,
/// without them, as commanded; NaN where either is missing.
std::array<double, 2> steps_made(const Run& run, std::size_t row);

/// Rows of a motion run over which its wheels went or turned at least so far: m and rad by them.
struct Stretch {
    std::size_t first, last;
    double way, turned;
};
/// One behind the other, each as short as may be; the pose is known at both ends. A stretch ends as well
/// where the tracker saw the robot go `least_tracked` m.
std::vector<Stretch> stretches_of(const Experiment& experiment, const Run& run, double least_way,
                                  double least_turn, double least_tracked = 1e300);

/// Rows of two robots in one file, where no column `unit` says so. Motion: InputError if a run's pose jumps
/// to and fro between two paths. Timing: InputError if `seq` does not count on; a caution where frames come
/// twice as often as `nominal_period` says. Proximity, ground, microphone: a caution if what was measured at
/// one placement falls into two levels, to and fro. Not seen: two robots of which each has runs of its own,
/// readings whose placements are never repeated, and other kinds.
void check_mixed(Experiment& experiment);

}  // namespace puckloop::gap
