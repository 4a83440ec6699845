#include "gap/stats/tails.h"

#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/gamma.hpp>

#include <cmath>

namespace puckloop::gap::stats {

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

double student_two_sided(double t, double degrees) {
    if (!(degrees > 0) || !std::isfinite(t)) return 1.0;
    return 2 * boost::math::cdf(boost::math::complement(boost::math::students_t(degrees), std::fabs(t)));
}

}  // namespace puckloop::gap::stats
