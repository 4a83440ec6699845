#pragma once
// Intervals of confidence, 95 % where the sample is large enough.

#include "base/random.h"

#include <functional>
#include <span>
#include <vector>

namespace puckloop::statistics {

struct Interval {
    double low = 0.0, high = 0.0;
    double coverage = 0.0;  ///< at least, 0..1
};

/// Of the median, by order statistics without any assumption on the distribution; of fewer than six values
/// their range, with the coverage that it has. NaN of none.
Interval median_interval(std::span<const double> values);

/// Of `statistic` by the percentile bootstrap (Efron, 1979), 2000 draws: each sample is drawn from itself
/// with replacement. Draws whose statistic is not finite are left out; NaN where none is left.
Interval bootstrap(const std::vector<std::vector<double>>& samples, RandomStream random,
                   const std::function<double(const std::vector<std::vector<double>>&)>& statistic);

}  // namespace puckloop::statistics
