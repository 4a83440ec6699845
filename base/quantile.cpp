#include "base/quantile.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace puckloop {

std::vector<double> finite(const std::vector<double>& values) {
    std::vector<double> kept;
    std::ranges::copy_if(values, std::back_inserter(kept), [](double v) { return std::isfinite(v); });
    return kept;
}

double quantile(const std::vector<double>& values, double q) {
    std::vector<double> kept = finite(values);
    std::ranges::sort(kept);
    return sorted_quantile(kept, q);
}

double sorted_quantile(const std::vector<double>& sorted, double q) {
    if (sorted.empty()) return NAN;
    const double place = q * static_cast<double>(sorted.size() - 1);
    const auto low = static_cast<std::size_t>(place);
    const std::size_t high = std::min(low + 1, sorted.size() - 1);
    return sorted[low] + (place - static_cast<double>(low)) * (sorted[high] - sorted[low]);
}

double median(const std::vector<double>& values) {
    return quantile(values, 0.5);
}

double upper_median(std::vector<double> values) {
    if (values.empty()) return NAN;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace puckloop
