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
/// Student's distribution, the constant of its density found once.
class StudentLaw {
  public:
    explicit StudentLaw(double degrees);
    double log_height() const { return log_height_; }  ///< ln of the density at 0
    double density(double t) const;
    double tail(double t) const;         ///< P(T > t)
    double beyond(double chance) const;  ///< t with P(T > t) = chance, 0 < chance < 1

  private:
    double degrees_, log_height_;
};
/// Chance that so many directions, each any way, add up to a sum this long (Rayleigh's test; Greenwood and
/// Durand 1955, as in Mardia and Jupp, Directional Statistics, 2000; good to a few hundredths from five on).
double rayleigh_tail(unsigned directions, double sum);
/// P(X >= count) of a binomial variable, 0 <= share <= 1.
double binomial_tail(unsigned of, double share, unsigned count);

}  // namespace puckloop::gap::stats
