#pragma once
// Ranks of values, ties sharing the mean of theirs.

#include <span>
#include <vector>

namespace puckloop::statistics {

/// From 1, in the order of `values`; no NaN.
std::vector<double> midranks(std::span<const double> values);

/// Sum over groups of t equal values of t^3 - t: what ties take from a variance of ranks.
double tie_sum(std::span<const double> values);

}  // namespace puckloop::statistics
