#pragma once
// Wilcoxon's two tests (Biometrics Bulletin 1, 1945), two-sided. The distribution is exact and conditional on
// the ties (Streitberg and Roehmel, 1986: counting by shifts); above a size it is the normal approximation
// with corrections for ties and continuity.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace puckloop::statistics {

struct RankTest {
    std::string method;  ///< "Wilcoxon signed-rank, exact"
    double statistic =
        0.0;            ///< signed-rank: sum of the ranks of positive differences; rank-sum: Mann-Whitney's U
    double p = 1.0;     ///< two-sided
    std::size_t n = 0;  ///< values that counted
};

/// Of paired differences; those that are zero are left out. Exact up to 200 of them.
RankTest signed_rank(std::span<const double> differences);

/// Of two samples that are not paired. Exact up to 80 values in all.
RankTest rank_sum(std::span<const double> x, std::span<const double> y);

/// Holm's adjustment for many tests (Scand. J. Statistics 6, 1979), in the order of `p`.
std::vector<double> holm(std::span<const double> p);

}  // namespace puckloop::statistics
