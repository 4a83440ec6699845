#pragma once
// The weak prior of a freed parameter: Student's t with two degrees of freedom, so that a value far out that
// the data knows well is not pulled back, as a normal prior would.

#include <cmath>

namespace puckloop::gap {

/// Minus its log without constants, `x` prior widths from the centre.
inline double prior_cost(double x) {
    return 1.5 * std::log1p(x * x / 2);
}
inline double prior_slope(double x) {
    return 3 * x / (2 + x * x);
}
/// Of the parabola with this slope that lies above the cost elsewhere: never negative.
inline double prior_curvature(double x) {
    return 3 / (2 + x * x);
}

}  // namespace puckloop::gap
