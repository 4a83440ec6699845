#pragma once
// Correction of p values for the number of tests made.

#include <vector>

namespace puckloop::gap::stats {

/// Holm's step-down adjusted p values: the chance of even one false alarm in the table stays below p.
std::vector<double> holm(const std::vector<double>& p);

}  // namespace puckloop::gap::stats
