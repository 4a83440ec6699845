#pragma once
// Power and noise by distance, as media of radio share it: power falls with one exponent of distance, and of
// frames that arrive with little more than a receiver needs some are lost in noise.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace puckloop::air {

/// m: closer, the far field's law does not hold.
inline constexpr double kNearest = 0.1;

template <std::size_t kDimensions>
double distance(const std::array<double, kDimensions>& a, const std::array<double, kDimensions>& b) {
    static_assert(kDimensions == 2 || kDimensions == 3);
    if constexpr (kDimensions == 2)
        return std::hypot(a[0] - b[0], a[1] - b[1]);
    else
        return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

inline double in_far_field(double distance) {
    return std::max(distance, kNearest);
}

/// dB by which power falls where distance grows by this factor.
inline double fall(double exponent, double factor) {
    return 10.0 * exponent * std::log10(factor);
}

/// Share of frames lost in noise that arrive `margin` dB above the sensitivity: a tenth with each dB more.
inline double lost_in_noise(double at_sensitivity, double margin) {
    return at_sensitivity * std::pow(10.0, -margin);
}

}  // namespace puckloop::air
