#pragma once
// Quantiles of measured values. NaN and infinite values are left out, if nothing else is stated.

#include <vector>

namespace puckloop {

/// The values that are finite.
std::vector<double> finite(const std::vector<double>& values);
/// By linear interpolation between order statistics (Hyndman and Fan's type 7), 0 <= q <= 1; NaN when empty.
double quantile(const std::vector<double>& values, double q);
/// The same of finite values in ascending order.
double sorted_quantile(const std::vector<double>& sorted, double q);
double median(const std::vector<double>& values);
/// The order statistic at n / 2 (of an even number the upper one of the two in the middle), in linear time.
/// No NaN allowed; NaN when empty.
double upper_median(std::vector<double> values);

}  // namespace puckloop
