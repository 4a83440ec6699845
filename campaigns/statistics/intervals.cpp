#include "campaigns/statistics/intervals.h"

#include "base/quantile.h"
#include "campaigns/statistics/distributions.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace puckloop::statistics {

namespace {

constexpr double kTail = 0.025;
constexpr int kDraws = 2000;

}  // namespace

Interval median_interval(std::span<const double> values) {
    std::vector<double> sorted(values.begin(), values.end());
    std::sort(sorted.begin(), sorted.end());
    const std::size_t n = sorted.size();
    if (n == 0) {
        const double none = std::numeric_limits<double>::quiet_NaN();
        return {none, none, 0.0};
    }
    // From the k-th to the k-th from the end: the median is outside where k - 1 or fewer values are beyond
    // it.
    std::size_t k = 1;
    while (2 * (k + 1) <= n && fair_binomial_up_to(k, n) <= kTail)
        ++k;
    return {sorted[k - 1], sorted[n - k], std::max(0.0, 1.0 - 2.0 * fair_binomial_up_to(k - 1, n))};
}

Interval bootstrap(const std::vector<std::vector<double>>& samples, RandomStream random,
                   const std::function<double(const std::vector<std::vector<double>>&)>& statistic) {
    std::vector<double> values;
    std::vector<std::vector<double>> drawn = samples;
    for (int draw = 0; draw < kDraws; ++draw) {
        for (std::size_t i = 0; i < samples.size(); ++i)
            for (double& value : drawn[i])
                value = samples[i][random.below(samples[i].size())];
        if (const double value = statistic(drawn); std::isfinite(value)) values.push_back(value);
    }
    std::sort(values.begin(), values.end());
    return {sorted_quantile(values, kTail), sorted_quantile(values, 1.0 - kTail), 1.0 - 2.0 * kTail};
}

}  // namespace puckloop::statistics
