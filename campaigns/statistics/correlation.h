#pragma once
// Correlation of ranks.

#include <span>

namespace puckloop::statistics {

/// Spearman's: Pearson's of the midranks. NaN with fewer than two pairs or where one side is constant.
double spearman(std::span<const double> x, std::span<const double> y);

}  // namespace puckloop::statistics
