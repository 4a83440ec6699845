#pragma once
// A run's poses beside its counters: what the tracker's clock and the counters' are told apart by.

#include "gap/data/experiment.h"

#include <vector>

namespace puckloop::gap {

struct CountedPath {
    /// A counter at some time: straight between its rows, standing before the first and after the last.
    struct Counter {
        double steps, rate;  ///< rate: steps/s
    };

    std::vector<double> time, way,
        heading;                       ///< of the tracker in rows with a whole pose: s, m and rad summed
    std::vector<double> when;          ///< s: where these stand on the counters' clock, as far as is known
    std::vector<double> counted_time;  ///< s
    std::vector<double> left, right;   ///< steps

    Counter left_at(double time) const { return at(left, time); }
    Counter right_at(double time) const { return at(right, time); }
    double middle() const { return (time.front() + time.back()) / 2; }
    double span() const { return time.back() - time.front(); }

  private:
    Counter at(const std::vector<double>& steps, double time) const;
};

/// One for each run of a motion experiment; empty where a run has no counters or too few rows (60).
std::vector<CountedPath> counted_paths(const Experiment& experiment);

/// Standard deviation from the middle of the errors' sizes: pushes and lost sight do not count. At least
/// 1e-9.
double robust_sd(std::vector<double> errors);

}  // namespace puckloop::gap
