#pragma once
// Intervals without a noise model: resample whole runs, or blocks of rows where runs are few.

#include "base/random.h"
#include "gap/stats/profile.h"
#include "gap/stats/series.h"

#include <cstdint>
#include <vector>

namespace puckloop::gap::stats {

/// Runs with replacement (blocks of 2.5 times the correlation length inside runs when there are fewer than
/// five runs): for each draw the rows it holds, repeats included.
std::vector<std::vector<std::size_t>> bootstrap_rows(const Series& series, int draws, RandomStream& random);

/// Means over a covariate with bands for a picture.
struct Band {
    std::vector<double> x, y, low, high;
};

Band bootstrap_band(const Series& residual, const std::vector<double>& covariate, int bins, double coverage,
                    std::uint64_t seed);

}  // namespace puckloop::gap::stats
