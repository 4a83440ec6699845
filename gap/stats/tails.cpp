#include "gap/stats/tails.h"

#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/gamma.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::gap::stats {

double normal_density(double z, double sd) {
    return std::exp(-z * z / (2 * sd * sd)) / (sd * std::sqrt(2 * std::numbers::pi));
}

double normal_tail(double z) {
    return 0.5 * std::erfc(z / std::sqrt(2.0));
}

double normal_quantile(double p) {
    return boost::math::quantile(boost::math::normal(), p);
}

double gamma_tail(double shape, double x) {
    return x <= 0 ? 1.0 : boost::math::gamma_q(shape, x);
}

double poisson_tail(double mean, unsigned count) {
    if (count == 0) return 1.0;
    return mean <= 0 ? 0.0 : boost::math::gamma_p(static_cast<double>(count), mean);
}

double fisher_tail(double f, double numerator, double denominator) {
    if (!(f > 0) || !(numerator > 0) || !(denominator > 0)) return 1.0;
    return boost::math::cdf(boost::math::complement(boost::math::fisher_f(numerator, denominator), f));
}

double student_quantile(double p, double degrees) {
    return boost::math::quantile(boost::math::students_t(degrees), p);
}

StudentLaw::StudentLaw(double degrees)
    : degrees_(degrees),
      log_height_(std::lgamma((degrees + 1) / 2) - std::lgamma(degrees / 2) -
                  0.5 * std::log(degrees * std::numbers::pi)) {}

double StudentLaw::density(double t) const {
    return std::exp(log_height_ - (degrees_ + 1) / 2 * std::log1p(t * t / degrees_));
}

double StudentLaw::tail(double t) const {
    return boost::math::cdf(boost::math::complement(boost::math::students_t(degrees_), t));
}

double StudentLaw::beyond(double chance) const {
    return boost::math::quantile(boost::math::complement(boost::math::students_t(degrees_), chance));
}

double rayleigh_tail(unsigned directions, double sum) {
    const double n = directions, rest = std::max(n * n - sum * sum, 0.0);
    return std::min(std::exp(std::sqrt(1 + 4 * n + 4 * rest) - (1 + 2 * n)), 1.0);
}

double binomial_tail(unsigned of, double share, unsigned count) {
    if (count == 0) return 1.0;
    if (count > of || !(share > 0)) return 0.0;
    return boost::math::ibeta(static_cast<double>(count), of - count + 1.0, std::min(share, 1.0));
}

}  // namespace puckloop::gap::stats
