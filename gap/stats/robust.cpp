#include "gap/stats/robust.h"

#include "gap/stats/series.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace puckloop::gap::stats {

namespace {

constexpr double kFiveToNinetyFive = 2 * 1.645;  // the same, in standard deviations

}  // namespace

double mean(const std::vector<double>& values) {
    const std::vector<double> kept = finite(values);
    if (kept.empty()) return NAN;
    return std::accumulate(kept.begin(), kept.end(), 0.0) / static_cast<double>(kept.size());
}

double standard_deviation(const std::vector<double>& values) {
    const std::vector<double> kept = finite(values);
    if (kept.size() < 2) return NAN;
    const double centre = mean(kept);
    double squares = 0;
    for (const double v : kept)
        squares += (v - centre) * (v - centre);
    return std::sqrt(squares / static_cast<double>(kept.size() - 1));
}

double robust_scale(const std::vector<double>& values) {
    std::vector<double> kept = finite(values);
    if (kept.size() < 2) return NAN;
    const double centre = median(kept);
    std::vector<double> distance(kept.size());
    std::transform(kept.begin(), kept.end(), distance.begin(),
                   [centre](double v) { return std::fabs(v - centre); });
    if (const double mad = median(distance); mad > 0) return kMadToSigma * mad;
    std::ranges::sort(kept);
    const double range = sorted_quantile(kept, 0.95) - sorted_quantile(kept, 0.05);
    return range > 0 ? range / kFiveToNinetyFive : standard_deviation(kept);
}

std::vector<double> winsorised(const std::vector<double>& values, double limit) {
    const double centre = median(values);
    const double reach = limit * robust_scale(values);
    std::vector<double> pulled = values;
    if (!(reach > 0)) return pulled;
    for (double& v : pulled)
        if (std::isfinite(v)) v = std::clamp(v, centre - reach, centre + reach);
    return pulled;
}

std::vector<double> ranks(const std::vector<double>& values) {
    const auto order = ordered(values.size(), [&](auto a, auto b) { return values[a] < values[b]; });
    std::vector<double> rank(values.size());
    for (std::size_t i = 0; i < order.size();) {
        std::size_t end = i + 1;
        while (end < order.size() && values[order[end]] == values[order[i]])
            ++end;
        const double shared = 0.5 * static_cast<double>(i + end + 1);
        for (; i < end; ++i)
            rank[order[i]] = shared;
    }
    return rank;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
    const double mean_a = mean(a), mean_b = mean(b);
    double cross = 0, square_a = 0, square_b = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        cross += (a[i] - mean_a) * (b[i] - mean_b);
        square_a += (a[i] - mean_a) * (a[i] - mean_a);
        square_b += (b[i] - mean_b) * (b[i] - mean_b);
    }
    return square_a > 0 && square_b > 0 ? cross / std::sqrt(square_a * square_b) : 0.0;
}

}  // namespace puckloop::gap::stats
