#pragma once
// Tail probabilities of the distributions the tests use.

namespace puckloop::gap::stats {

/// Density of a normal deviation of this sd.
double normal_density(double z, double sd = 1.0);
/// P(Z > z) of the standard normal.
double normal_tail(double z);
/// z with P(Z <= z) = p, 0 < p < 1.
double normal_quantile(double p);
/// P(G > x) of a gamma distribution with the given shape (> 0) and scale 1.
double gamma_tail(double shape, double x);
/// P(X >= count) of a Poisson variable with the given mean.
double poisson_tail(double mean, unsigned count);
/// P(F > f) of Fisher's distribution.
double fisher_tail(double f, double numerator, double denominator);
/// t with P(T <= t) = p of Student's distribution, 0 < p < 1.
double student_quantile(double p, double degrees);
/// P(X >= count) of a binomial variable, 0 <= share <= 1.
double binomial_tail(unsigned of, double share, unsigned count);

}  // namespace puckloop::gap::stats
