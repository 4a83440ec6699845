#pragma once
// Largest minus smallest of n samples of noise.

namespace puckloop::gap {

/// Expected for n (2 or more, whole or not) independent standard normal samples: 1.128 for 2, 5.015 for 100.
double normal_range(double n);

/// Its standard deviation, by the extremes' limiting law: within 2 % of 0.605 for 100, 5 % of 0.797 for 10.
double normal_range_sd(double n);

}  // namespace puckloop::gap
