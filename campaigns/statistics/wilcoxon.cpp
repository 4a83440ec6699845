#include "campaigns/statistics/wilcoxon.h"

#include "campaigns/statistics/distributions.h"
#include "campaigns/statistics/ranks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace puckloop::statistics {

namespace {

constexpr std::size_t kExactPairs = 200, kExactValues = 80;

/// Midranks are multiples of a half: twice them are whole.
std::vector<std::size_t> doubled(const std::vector<double>& ranks) {
    std::vector<std::size_t> whole;
    for (const double rank : ranks)
        whole.push_back(static_cast<std::size_t>(std::llround(2.0 * rank)));
    return whole;
}

/// Two-sided p of `at` among `ways`, how many outcomes have each value.
double two_sided(const std::vector<double>& ways, std::size_t at) {
    const auto split = ways.begin() + static_cast<std::ptrdiff_t>(at);
    const double all = std::accumulate(ways.begin(), ways.end(), 0.0);
    const double below = std::accumulate(ways.begin(), split + 1, 0.0),
                 above = std::accumulate(split, ways.end(), 0.0);
    return std::min(1.0, 2.0 * std::min(below, above) / all);
}

/// With half a step towards the mean.
double two_sided_normal(double statistic, double mean, double variance) {
    if (!(variance > 0.0)) return 1.0;
    const double distance = std::max(0.0, std::abs(statistic - mean) - 0.5);
    return std::min(1.0, 2.0 * normal_above(distance / std::sqrt(variance)));
}

}  // namespace

RankTest signed_rank(std::span<const double> differences) {
    std::vector<double> sizes;
    std::vector<bool> positive;
    for (const double difference : differences)
        if (difference != 0.0) {
            sizes.push_back(std::abs(difference));
            positive.push_back(difference > 0.0);
        }
    const std::vector<double> ranks = midranks(sizes);
    RankTest test{"Wilcoxon signed-rank, exact", 0.0, 1.0, sizes.size()};
    for (std::size_t i = 0; i < ranks.size(); ++i)
        if (positive[i]) test.statistic += ranks[i];
    const auto n = static_cast<double>(sizes.size());
    if (sizes.empty()) return test;
    if (sizes.size() > kExactPairs) {
        test.method = "Wilcoxon signed-rank, normal approximation";
        test.p = two_sided_normal(test.statistic, n * (n + 1) / 4,
                                  n * (n + 1) * (2 * n + 1) / 24 - tie_sum(sizes) / 48);
        return test;
    }
    std::vector<double> ways{1.0};
    for (const std::size_t rank : doubled(ranks)) {
        std::vector<double> next(ways.size() + rank, 0.0);
        for (std::size_t sum = 0; sum < ways.size(); ++sum) {
            next[sum] += ways[sum];
            next[sum + rank] += ways[sum];
        }
        ways = std::move(next);
    }
    test.p = two_sided(ways, static_cast<std::size_t>(std::llround(2.0 * test.statistic)));
    return test;
}

RankTest rank_sum(std::span<const double> x, std::span<const double> y) {
    std::vector<double> all(x.begin(), x.end());
    all.insert(all.end(), y.begin(), y.end());
    RankTest test{"Wilcoxon rank-sum (Mann-Whitney), exact", 0.0, 1.0, all.size()};
    if (x.empty() || y.empty()) return test;
    const std::vector<double> ranks = midranks(all);
    const double sum =
        std::accumulate(ranks.begin(), ranks.begin() + static_cast<std::ptrdiff_t>(x.size()), 0.0);
    const auto m = static_cast<double>(x.size()), k = static_cast<double>(y.size()), n = m + k;
    test.statistic = sum - m * (m + 1) / 2;
    if (all.size() > kExactValues) {
        test.method = "Wilcoxon rank-sum (Mann-Whitney), normal approximation";
        test.p =
            two_sided_normal(test.statistic, m * k / 2, m * k / 12 * (n + 1 - tie_sum(all) / (n * (n - 1))));
        return test;
    }
    // ways[size][sum]: subsets of the ranks seen up to now.
    const std::vector<std::size_t> whole = doubled(ranks);
    const std::size_t most = std::accumulate(whole.begin(), whole.end(), std::size_t{0});
    std::vector<std::vector<double>> ways(x.size() + 1, std::vector<double>(most + 1, 0.0));
    ways[0][0] = 1.0;
    for (const std::size_t rank : whole)
        for (std::size_t size = x.size(); size >= 1; --size)
            for (std::size_t total = most; total >= rank; --total)
                ways[size][total] += ways[size - 1][total - rank];
    test.p = two_sided(ways[x.size()], static_cast<std::size_t>(std::llround(2.0 * sum)));
    return test;
}

std::vector<double> holm(std::span<const double> p) {
    std::vector<std::size_t> order(p.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
    std::vector<double> adjusted(p.size());
    double highest = 0.0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        highest = std::max(highest, std::min(1.0, p[order[i]] * static_cast<double>(p.size() - i)));
        adjusted[order[i]] = highest;
    }
    return adjusted;
}

}  // namespace puckloop::statistics
