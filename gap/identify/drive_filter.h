#pragma once
// A drive as a state space: in each row the wheels truly go some way, the counters count it with an error
// that stays in their sums, the robot moves by what its wheels went and slips, and a tracker sees where it
// is. The likelihood of all that was measured, with every noise estimated, is exact for normal noise (Kalman
// 1960); rows far out pull as those of Student's t. So a number by which counts are multiplied is not drawn
// to nothing by the counts' own noise (errors in variables: Fuller 1987).
//
// Two channels, the way and the turn, each with three states: the pose, the counters' sum, the wheels' speed,
// which is a random walk that begins again where a counted speed jumps.
//
// Deviations: 1. the way across the heading is left out. 2. What a cause does to a row is taken as linear in
// the counts' error.

#include <cstddef>
#include <optional>
#include <vector>

namespace puckloop::gap {

/// What is known of one channel in each row: metres counted, and what of it reaches the pose by two models
/// between which a drive lies.
struct DriveChannel {
    std::vector<double> counted;        ///< m in this row: the wheels' mean, or right less left
    std::vector<double> seen;           ///< pose, m or rad
    std::vector<double> without, with;  ///< change of the pose that the counts make, by either model
    std::vector<double> gain_without, gain_with;  ///< of that, by a metre counted
    double errors = 1.0;  ///< variance of `counted`, in variances of one wheel's counter
};

struct CountedDrive {
    std::vector<char> starts;   ///< 1: a run begins
    std::vector<double> spans;  ///< s since the row before
    DriveChannel way, turn;
    double quantum = 0.0;  ///< m of a count
};

/// Which noises a fit may have beside the tracker's.
struct DriveNoise {
    bool counters = true, slip = true;
};

struct DriveFit {
    double cost = 0.0;                       ///< minus ln likelihood, nats
    double share = 0.0, share_sd = 0.0;      ///< of what parts `with` from `without`
    double counter_sd = 0.0;                 ///< m a row, of each wheel's counter
    double slip_way = 0.0, slip_turn = 0.0;  ///< sd a row, m and rad
    double seen_way = 0.0, seen_turn = 0.0;  ///< of the tracker
};

/// With the share free, or held at `share`.
DriveFit fit_drive(const CountedDrive& drive, const DriveNoise& noise,
                   const std::optional<double>& share = {});

}  // namespace puckloop::gap
