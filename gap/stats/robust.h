#pragma once
// Location, scale and quantiles that a few wild values cannot move. NaN values are left out throughout.

#include <vector>

namespace puckloop::gap::stats {

/// The values that are finite.
std::vector<double> finite(const std::vector<double>& values);
/// Mean of the finite values; NaN when there is none.
double mean(const std::vector<double>& values);
/// Sample standard deviation (n - 1); NaN below two values.
double standard_deviation(const std::vector<double>& values);
/// Quantile by linear interpolation between order statistics, 0 <= q <= 1; NaN when empty.
double quantile(std::vector<double> values, double q);
double median(const std::vector<double>& values);
/// The order statistic at n / 2 (of an even number the upper one of the two in the middle), in linear time.
/// No NaN allowed; NaN when empty.
double upper_median(std::vector<double> values);
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
