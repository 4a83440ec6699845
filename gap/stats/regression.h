#pragma once
// Straight lines with errors that hold when rows of a block depend on each other.

#include "gap/stats/exchange.h"

namespace puckloop::gap::stats {

struct Line {
    double slope = 0.0, intercept = 0.0;
    double slope_error = 0.0;      ///< from the scatter between blocks (or runs), not between rows
    double intercept_error = 0.0;  ///< likewise
    double clusters = 0.0;
};

/// Least squares of y on x with cluster-robust errors; the clusters are the pairs' blocks.
Line clustered_line(const Pairs& pairs);

}  // namespace puckloop::gap::stats
