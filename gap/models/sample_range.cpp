#include "gap/models/sample_range.h"

#include "gap/stats/tails.h"

#include <cmath>
#include <numbers>

namespace puckloop::gap {

namespace {
constexpr double kFar = 7.0;     // deviations: nothing is beyond
constexpr double kStep = 0.025;  // trapezoids; exact to 1e-6 for so smooth a function
}  // namespace

double normal_range(double n) {
    // E(max - min) = integral of the probability that some sample is above x and some below
    double sum = 0.0;
    for (double x = 0.0; x < kFar; x += kStep) {
        const double below = stats::normal_tail(-x), above = 1.0 - below;
        const double between = 1.0 - std::pow(below, n) - std::pow(above, n);
        sum += x == 0.0 ? between / 2 : between;
    }
    return 2.0 * sum * kStep;  // even in x
}

double normal_range_sd(double n) {
    return std::numbers::pi / std::numbers::sqrt3 / std::sqrt(2.0 * std::log(n));
}

}  // namespace puckloop::gap
