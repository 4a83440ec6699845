#pragma once
// Tail probabilities of the distributions that tests refer to.

#include <cstddef>

namespace puckloop::statistics {

/// P(X >= x) of a standard normal variable.
double normal_above(double x);

/// P(X >= x) of chi-square with `freedom` degrees of freedom (> 0): the upper regularised incomplete gamma
/// function, as a series below its mean and a continued fraction above. 1 for x <= 0.
double chi_square_above(double x, double freedom);

/// P(X <= k) of a binomial variable with n trials of probability 1/2.
double fair_binomial_up_to(std::size_t k, std::size_t n);

}  // namespace puckloop::statistics
