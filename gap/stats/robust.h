#pragma once
// Location, scale and quantiles that a few wild values cannot move. NaN values are left out throughout.

#include "base/quantile.h"

#include <vector>

namespace puckloop::gap::stats {

using puckloop::finite, puckloop::median, puckloop::quantile, puckloop::upper_median;

/// Mean of the finite values; NaN when there is none.
double mean(const std::vector<double>& values);
/// Sample standard deviation (n - 1); NaN below two values.
double standard_deviation(const std::vector<double>& values);
/// A normal sample's standard deviation over its median absolute deviation.
inline constexpr double kMadToSigma = 1.4826;

/// Standard deviation that a normal sample would have: 1.4826 times the median absolute deviation. When more
/// than half the values are equal (clipped, quantised), the 5-95 % range over 3.29, then the plain deviation.
double robust_scale(const std::vector<double>& values);

/// Values farther than `limit` robust scales from the median are pulled in to that distance.
std::vector<double> winsorised(const std::vector<double>& values, double limit = 4.0);

/// Ranks 1..n, ties share their mean rank. No NaN allowed.
std::vector<double> ranks(const std::vector<double>& values);

/// Pearson correlation; 0 when either is constant.
double correlation(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace puckloop::gap::stats
