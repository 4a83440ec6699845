#pragma once
// Friedman's test (J. Am. Statistical Association 32, 1937): do treatments rank alike in all blocks?

#include <cstddef>
#include <vector>

namespace puckloop::statistics {

struct Friedman {
    double chi_square = 0.0;  ///< corrected for ties
    std::size_t freedom = 0;  ///< treatments - 1
    double p = 1.0;           ///< by the chi-square approximation
    std::size_t blocks = 0;
    std::vector<double> mean_ranks;  ///< of the treatments; 1 is the lowest value
};

/// One row per block, one value per treatment in each. p = 1 with fewer than two of either, and where all
/// values of every block are equal.
Friedman friedman(const std::vector<std::vector<double>>& blocks);

}  // namespace puckloop::statistics
