#include "campaigns/statistics/correlation.h"

#include "campaigns/statistics/ranks.h"

#include <cmath>
#include <limits>

namespace puckloop::statistics {

double spearman(std::span<const double> x, std::span<const double> y) {
    const std::vector<double> a = midranks(x), b = midranks(y);
    const double mean = (static_cast<double>(x.size()) + 1) / 2;
    double both = 0.0, first = 0.0, second = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        both += (a[i] - mean) * (b[i] - mean);
        first += (a[i] - mean) * (a[i] - mean);
        second += (b[i] - mean) * (b[i] - mean);
    }
    if (!(first > 0.0 && second > 0.0)) return std::numeric_limits<double>::quiet_NaN();
    return both / std::sqrt(first * second);
}

}  // namespace puckloop::statistics
