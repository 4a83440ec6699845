#include "campaigns/statistics/distributions.h"

#include <algorithm>
#include <cmath>

namespace puckloop::statistics {

namespace {

constexpr int kMostTerms = 10'000;
constexpr double kPrecision = 1e-15;

/// x^a e^-x / Gamma(a).
double gamma_factor(double a, double x) {
    return std::exp(a * std::log(x) - x - std::lgamma(a));
}

double lower_by_series(double a, double x) {
    double term = 1.0 / a, sum = term;
    for (int n = 1; n < kMostTerms && term > sum * kPrecision; ++n) {
        term *= x / (a + n);
        sum += term;
    }
    return sum * gamma_factor(a, x);
}

/// The continued fraction x + 1 - a - (1 - a) / (x + 3 - a - ...), by Lentz's method.
double upper_by_fraction(double a, double x) {
    constexpr double kTiny = 1e-300;
    double b = x + 1.0 - a, c = 1.0 / kTiny, d = 1.0 / b, value = d;
    for (int n = 1; n < kMostTerms; ++n) {
        const double numerator = -n * (n - a);
        b += 2.0;
        d = numerator * d + b;
        if (std::abs(d) < kTiny) d = kTiny;
        c = b + numerator / c;
        if (std::abs(c) < kTiny) c = kTiny;
        d = 1.0 / d;
        const double factor = d * c;
        value *= factor;
        if (std::abs(factor - 1.0) < kPrecision) break;
    }
    return value * gamma_factor(a, x);
}

}  // namespace

double normal_above(double x) {
    return 0.5 * std::erfc(x / std::sqrt(2.0));
}

double chi_square_above(double x, double freedom) {
    if (!(x > 0.0)) return 1.0;
    const double a = freedom / 2.0, half = x / 2.0;
    const double p = half < a + 1.0 ? 1.0 - lower_by_series(a, half) : upper_by_fraction(a, half);
    return std::clamp(p, 0.0, 1.0);
}

double fair_binomial_up_to(std::size_t k, std::size_t n) {
    if (k >= n) return 1.0;
    double sum = 0.0;
    for (std::size_t i = 0; i <= k; ++i)
        sum += std::exp(std::lgamma(static_cast<double>(n) + 1) - std::lgamma(static_cast<double>(i) + 1) -
                        std::lgamma(static_cast<double>(n - i) + 1) - static_cast<double>(n) * std::log(2.0));
    return std::min(sum, 1.0);
}

}  // namespace puckloop::statistics
